#include "core/exec/executor.hpp"

#include <cxxabi.h>

#include <cstdlib>

namespace bb::exec {

std::string KernelInfo::name() const {
  int status = 0;
  char* text = abi::__cxa_demangle(type.name(), nullptr, nullptr, &status);
  std::string out = text ? text : type.name();
  std::free(text);
  return out;
}

void* Executor::allocate(const std::string& name, std::size_t bytes) {
  ledger_.add(name, bytes);
  void* memory = allocate_bytes(bytes);
  if (memory || bytes == 0 || counts_only()) return memory;
  ledger_.remove(name, bytes);
  const std::string state = memory_state();
  throw OutOfMemory(ledger_.refusal(name, bytes) + (state.empty() ? "" : "; " + state));
}

void Executor::release(const std::string& name, void* memory, std::size_t bytes) {
  release_bytes(memory);
  ledger_.remove(name, bytes);
}

void RecordedGraph::add(const KernelInfo& kernel, Index n, const void* f) {
  constexpr std::size_t unit = sizeof(std::max_align_t);
  auto bytes = std::make_unique<std::max_align_t[]>((kernel.bytes + unit - 1) / unit);
  memcpy(bytes.get(), f, kernel.bytes);
  launches_.push_back({&kernel, n, std::move(bytes)});
}

}  // namespace bb::exec
