// The only <<< >>> of the project: a functor, put on a stream.
#pragma once

#include "core/cuda/device_block.cuh"
#include "core/cuda/kernel_table.hpp"

namespace bb::cuda {

template <class F>
int launch_each(const void* f, exec::Index n, CUstream_st* stream) {
  const exec::Index blocks = exec::blocks_for(n);
  if (blocks > exec::most_blocks) return cudaErrorInvalidConfiguration;
  exec::run_each<F>
      <<<static_cast<unsigned>(blocks), exec::block_threads, 0, stream>>>(n, *static_cast<const F*>(f));
  return cudaGetLastError();
}

template <class F>
int launch_blocks(const void* f, exec::Index n, CUstream_st* stream) {
  if (n > exec::most_blocks) return cudaErrorInvalidConfiguration;
  exec::run_blocks<F>
      <<<static_cast<unsigned>(n), exec::block_threads, 0, stream>>>(*static_cast<const F*>(f));
  return cudaGetLastError();
}

template <class F>
void add_each(KernelTable& table) {
  table.add(typeid(F), {&launch_each<F>, sizeof(F), reinterpret_cast<const void*>(&exec::run_each<F>)});
}
template <class F>
void add_blocks(KernelTable& table) {
  table.add(typeid(F), {&launch_blocks<F>, sizeof(F), reinterpret_cast<const void*>(&exec::run_blocks<F>)});
}

}  // namespace bb::cuda
