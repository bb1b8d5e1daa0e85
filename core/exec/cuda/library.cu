#include "core/exec/cuda/library.hpp"

#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>

namespace bb::cuda {
namespace {
struct Plus {
  __host__ __device__ exec::Index operator()(exec::Index a, exec::Index b) const { return a + b; }
};
}  // namespace

int sort_by_key(void* scratch, std::size_t& scratch_bytes, TwoArrays<exec::Key>& keys,
                TwoArrays<std::uint32_t>& values, exec::Index n, int bits, CUstream_st* stream) {
  cub::DoubleBuffer<exec::Key> k(keys.array[0], keys.array[1]);
  cub::DoubleBuffer<std::uint32_t> v(values.array[0], values.array[1]);
  const cudaError_t code =
      values.array[0] ? cub::DeviceRadixSort::SortPairs(scratch, scratch_bytes, k, v, n, 0, bits, stream)
                      : cub::DeviceRadixSort::SortKeys(scratch, scratch_bytes, k, n, 0, bits, stream);
  keys.current = k.selector;
  values.current = v.selector;
  return code;
}

int scan_exclusive(void* scratch, std::size_t& scratch_bytes, exec::Index* values, int n, exec::Index first,
                   CUstream_st* stream) {
  return cub::DeviceScan::ExclusiveScan(scratch, scratch_bytes, values, values, Plus{}, first, n, stream);
}

}  // namespace bb::cuda
