// The one launch of the project.
#include <cuda_runtime_api.h>

#include "core/exec/cuda/kernel_table.hpp"

namespace bb::cuda {

using exec::Index;

// The card's limit; of run_each that is 1e11 items, more than any memory holds.
constexpr Index most_blocks = 0x7fffffff;

int launch(const DeviceKernel& kernel, const void* f, Index n, int threads, CUstream_st* stream) {
  const Index blocks = kernel.blocks ? n : (n + threads - 1) / threads;
  if (blocks > most_blocks) return cudaErrorInvalidConfiguration;
  void* functor = const_cast<void*>(f);  // it is copied
  void* of_each[] = {&n, functor};
  void* of_blocks[] = {functor};
  const cudaError_t code =
      cudaLaunchKernel(kernel.function, dim3(static_cast<unsigned>(blocks)),
                       dim3(static_cast<unsigned>(threads)), kernel.blocks ? of_blocks : of_each, 0, stream);
  if (code != cudaSuccess) cudaGetLastError();  // it is reported here; no later call shall report it
  return code;
}

}  // namespace bb::cuda
