// The kernel of a functor, as the table has it: that of a device compiler, which alone may see this.
#pragma once

#include "core/exec/cuda/device_block.cuh"
#include "core/exec/cuda/kernel_table.hpp"

namespace bb::cuda {

template <class F>
DeviceKernel each_kernel() {
  return {reinterpret_cast<const void*>(&exec::run_each<F>), sizeof(F), false};
}
template <class F>
DeviceKernel blocks_kernel() {
  return {reinterpret_cast<const void*>(&exec::run_blocks<F>), sizeof(F), true};
}

template <class F>
void add_each(KernelTable& table) {
  if constexpr (!std::is_same_v<F, exec::NoKernel>) table.add(typeid(F), each_kernel<F>());
}
template <class F>
void add_blocks(KernelTable& table) {
  table.add(typeid(F), blocks_kernel<F>());
}

}  // namespace bb::cuda
