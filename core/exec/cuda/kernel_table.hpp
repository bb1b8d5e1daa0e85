// Which kernels have a device version: by the type of the functor, filled from the kernel lists of the modules.
// No CUDA header, so that C++ files can read it.
#pragma once

#include <typeindex>
#include <unordered_map>

#include "core/exec/kernel.hpp"

struct CUstream_st;  // what a cudaStream_t points at

namespace bb::cuda {

struct DeviceKernel {
  const void* function;  // as the run time knows it
  std::size_t bytes;     // of the functor as the device compiler lays it out
  bool blocks;           // run_blocks, else run_each
};

/// Puts n items, or n blocks, of the functor at f on a stream. threads: of a block. @return a cudaError_t; 0 is success
int launch(const DeviceKernel& kernel, const void* f, exec::Index n, int threads, CUstream_st* stream);

class KernelTable {
 public:
  void add(const std::type_info& type, DeviceKernel kernel) { kernels_.insert_or_assign(type, kernel); }
  /// Null for a kernel without a device version.
  const DeviceKernel* find(const std::type_info& type) const {
    const auto found = kernels_.find(type);
    return found == kernels_.end() ? nullptr : &found->second;
  }
  std::size_t size() const { return kernels_.size(); }
  /// call(kernel), in any order.
  template <class Call>
  void for_each(const Call& call) const {
    for (const auto& [type, kernel] : kernels_) call(kernel);
  }

 private:
  std::unordered_map<std::type_index, DeviceKernel> kernels_;
};

/// The kernels that every DeviceExecutor of the process finds: those of the modules from the start.
KernelTable& kernel_table();
/// Adds the kernels of every module (generated).
void add_kernels_of_modules(KernelTable& table);

}  // namespace bb::cuda
