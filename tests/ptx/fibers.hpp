// Stacks of their own for the threads of a block, and switching between them.
#pragma once

#include <cstddef>
#include <vector>

namespace ptx {

/// A thread of control that runs where it is resumed.
class Fibers {
 public:
  explicit Fibers(std::size_t n);
  ~Fibers();
  Fibers(const Fibers&) = delete;

  /// Fiber i begins anew: entry(argument) when it is first resumed. It must end by leaving through yield().
  void start(std::size_t i, void (*entry)(void*), void* argument);
  /// From the scheduler: runs fiber i until it yields.
  void resume(std::size_t i);
  /// From a fiber: back to the scheduler.
  void yield();

 private:
  struct Context;
  static constexpr std::size_t stack_bytes = std::size_t{1} << 20;
  unsigned char* stacks_;
  std::vector<Context*> contexts_;
  Context* scheduler_;
  std::size_t running_ = 0;
};

}  // namespace ptx
