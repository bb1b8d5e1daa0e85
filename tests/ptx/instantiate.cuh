// One line a kernel: its instance for the device.
#pragma once

#define EACH(...)                                                           \
  template __global__ void bb::exec::run_each<__VA_ARGS__>(bb::exec::Index, \
                                                           const __grid_constant__ __VA_ARGS__);
#define BLOCKS(...) \
  template __global__ void bb::exec::run_blocks<__VA_ARGS__>(const __grid_constant__ __VA_ARGS__);
