#include "tests/ptx/fibers.hpp"

#include <sys/mman.h>

#include <cstdint>
#include <cstdlib>
#include <new>

#ifndef __x86_64__
#include <ucontext.h>
#endif

namespace ptx {

#ifdef __x86_64__

// Saves the registers that a call keeps on the old stack and takes them from the new one: a few nanoseconds, where
// swapcontext calls the kernel for the signal mask twice.
extern "C" void bb_ptx_switch(void** save, void* to);
asm(R"(
.text
.globl bb_ptx_switch
.type bb_ptx_switch, @function
bb_ptx_switch:
  pushq %rbp
  pushq %rbx
  pushq %r12
  pushq %r13
  pushq %r14
  pushq %r15
  movq %rsp, (%rdi)
  movq %rsi, %rsp
  popq %r15
  popq %r14
  popq %r13
  popq %r12
  popq %rbx
  popq %rbp
  ret
.size bb_ptx_switch, .-bb_ptx_switch
)");

struct Fibers::Context {
  void* stack = nullptr;
  void (*entry)(void*) = nullptr;
  void* argument = nullptr;
};
namespace {
struct Start {
  void (*entry)(void*);
  void* argument;
};
thread_local Start starting;
void begin() {
  const Start start = starting;
  start.entry(start.argument);
  std::abort();  // an entry does not return
}
}  // namespace

void Fibers::start(std::size_t i, void (*entry)(void*), void* argument) {
  auto* top = reinterpret_cast<void**>(stacks_ + (i + 1) * stack_bytes) - 2;
  *top = reinterpret_cast<void*>(
      &begin);  // where the first switch returns to, the stack aligned as after a call
  for (int k = 0; k < 6; ++k) *--top = nullptr;
  *contexts_[i] = {top, entry, argument};
}
void Fibers::resume(std::size_t i) {
  running_ = i;
  starting = {contexts_[i]->entry, contexts_[i]->argument};
  bb_ptx_switch(&scheduler_->stack, contexts_[i]->stack);
}
void Fibers::yield() { bb_ptx_switch(&contexts_[running_]->stack, scheduler_->stack); }

#else

struct Fibers::Context {
  ucontext_t context;
  void (*entry)(void*) = nullptr;
  void* argument = nullptr;
};
namespace {
void begin(unsigned high, unsigned low) {
  auto* of = reinterpret_cast<void**>(std::uintptr_t{high} << 32 | low);
  reinterpret_cast<void (*)(void*)>(of[0])(of[1]);
  std::abort();
}
}  // namespace

void Fibers::start(std::size_t i, void (*entry)(void*), void* argument) {
  Context& c = *contexts_[i];
  c.entry = entry, c.argument = argument;
  getcontext(&c.context);
  c.context.uc_stack.ss_sp = stacks_ + i * stack_bytes + 4096;
  c.context.uc_stack.ss_size = stack_bytes - 4096;
  c.context.uc_link = nullptr;
  const auto of = reinterpret_cast<std::uintptr_t>(&c.entry);
  makecontext(&c.context, reinterpret_cast<void (*)()>(&begin), 2, static_cast<unsigned>(of >> 32),
              static_cast<unsigned>(of & 0xffffffff));
}
void Fibers::resume(std::size_t i) {
  running_ = i;
  swapcontext(&scheduler_->context, &contexts_[i]->context);
}
void Fibers::yield() { swapcontext(&contexts_[running_]->context, &scheduler_->context); }

#endif

// One page below each stack traps its overflow; pages that nobody touches cost nothing.
Fibers::Fibers(std::size_t n) {
  void* memory = mmap(nullptr, n * stack_bytes, PROT_READ | PROT_WRITE,
                      MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  stacks_ = static_cast<unsigned char*>(memory);
  for (std::size_t i = 0; i < n; ++i) {
    mprotect(stacks_ + i * stack_bytes, 4096, PROT_NONE);
    contexts_.push_back(new Context);
  }
  scheduler_ = new Context;
}
Fibers::~Fibers() {
  munmap(stacks_, contexts_.size() * stack_bytes);
  for (Context* c : contexts_) delete c;
  delete scheduler_;
}

}  // namespace ptx
