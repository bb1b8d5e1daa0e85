// Device versions of the test's kernels.
#include "tests/standin/device_kernels.hpp"

#include "core/exec/cuda/table_entries.cuh"

namespace bb::device_kernels {

void add_to(cuda::KernelTable& table) {
  using cuda::add_blocks, cuda::add_each;
#define EACH(...) add_each<__VA_ARGS__>(table);
#define BLOCKS(...) add_blocks<__VA_ARGS__>(table);
#include "tests/standin/device_kernels.inc"
#undef EACH
#undef BLOCKS
}

}  // namespace bb::device_kernels
