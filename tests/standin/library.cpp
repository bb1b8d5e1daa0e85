// core/exec/cuda/library.hpp without CUB, which needs a card: the standard library on the stand-in's device memory.
#include "core/exec/cuda/library.hpp"

#include <algorithm>
#include <numeric>

#include "tests/standin/cudart.hpp"

namespace bb::cuda {

using exec::Index;
using exec::Key;
constexpr std::size_t scratch_needed = 1000;

/// Whether the scratch memory is there; what lies in it is overwritten.
bool use_scratch(void* scratch, std::size_t bytes) {
  if (bytes < scratch_needed || !standin::on_device(scratch, bytes)) return false;
  memset(scratch, 0xee, bytes);
  return true;
}

// CUB goes from one array to the other once for each 8 bits.
int sort_by_key(void* scratch, std::size_t& scratch_bytes, TwoArrays<Key>& keys,
                TwoArrays<std::uint32_t>& values, Index n, int bits, CUstream_st* stream) {
  if (!scratch) {
    scratch_bytes = scratch_needed;
    return cudaSuccess;
  }
  const std::size_t bytes = scratch_bytes, size = static_cast<std::size_t>(n);
  const int last = (bits + 7) / 8 % 2;
  const TwoArrays<Key> k = keys;
  const TwoArrays<std::uint32_t> v = values;
  keys.current = values.current = last;
  return standin::enqueue(stream, [=] {
    if (!use_scratch(scratch, bytes)) return cudaErrorIllegalAddress;
    for (const Key* array : k.array) {
      if (!standin::on_device(array, size * sizeof(Key))) return cudaErrorIllegalAddress;
    }
    const Key mask = bits == 64 ? ~Key{0} : (Key{1} << bits) - 1;
    std::vector<std::size_t> order(size);
    std::iota(order.begin(), order.end(), std::size_t{0});
    const std::vector<Key> old(k.array[0], k.array[0] + n);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return (old[a] & mask) < (old[b] & mask); });
    memset(k.array[1 - last], 0xee, size * sizeof(Key));  // the other one is not to be read
    for (std::size_t i = 0; i < size; ++i) k.array[last][i] = old[order[i]];
    if (!v.array[0]) return cudaSuccess;
    const std::vector<std::uint32_t> old_values(v.array[0], v.array[0] + n);
    memset(v.array[1 - last], 0xee, size * sizeof(std::uint32_t));
    for (std::size_t i = 0; i < size; ++i) v.array[last][i] = old_values[order[i]];
    return cudaSuccess;
  });
}

int scan_exclusive(void* scratch, std::size_t& scratch_bytes, Index* values, int n, Index first,
                   CUstream_st* stream) {
  if (!scratch) {
    scratch_bytes = scratch_needed;
    return cudaSuccess;
  }
  const std::size_t bytes = scratch_bytes;
  return standin::enqueue(stream, [=] {
    if (!use_scratch(scratch, bytes)) return cudaErrorIllegalAddress;
    if (!standin::on_device(values, static_cast<std::size_t>(n) * sizeof(Index)))
      return cudaErrorIllegalAddress;
    std::exclusive_scan(values, values + n, values, first);
    return cudaSuccess;
  });
}

}  // namespace bb::cuda
