// The memory that cuDSS takes for its factor, as memory of the executor: named and counted like a buffer.
#pragma once

#include <cudss.h>

#include <exception>
#include <map>

#include "core/exec/executor.hpp"

namespace bb::cudss {

/// Must outlive the handle that it is given to, and the data of that handle.
class FactorMemory {
 public:
  /// The executor must outlive it.
  explicit FactorMemory(exec::Executor& executor) : executor_(executor) {}
  FactorMemory(const FactorMemory&) = delete;
  FactorMemory& operator=(const FactorMemory&) = delete;

  cudssDeviceMemHandler_t handler();
  /// Why the last allocation failed, once; null when none did. No exception can pass through the library.
  std::exception_ptr take_error() { return std::exchange(error_, nullptr); }

 private:
  static int allocate(void* self, void** memory, std::size_t bytes, cudaStream_t stream);
  static int release(void* self, void* memory, std::size_t bytes, cudaStream_t stream);

  exec::Executor& executor_;
  std::map<void*, std::size_t> bytes_;
  std::exception_ptr error_;
};

}  // namespace bb::cudss
