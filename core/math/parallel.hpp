// Loops over items that write their own slots: results do not depend on the number of threads.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstddef>

namespace bb {

/// Calls f(i) for i in [0, n), in any order; grain items or fewer run as one task.
template <class Index, class F>
void parallel_items(Index n, std::size_t grain, const F& f) {
  tbb::parallel_for(tbb::blocked_range<Index>(0, n, grain), [&f](const tbb::blocked_range<Index>& range) {
    for (Index i = range.begin(); i != range.end(); ++i) f(i);
  });
}

/// Blocks of fixed size, for what has to be gathered in one order: f(block, begin, end).
inline constexpr std::size_t block_items = 1024;
constexpr std::size_t n_blocks(std::size_t n, std::size_t size = block_items) {
  return (n + size - 1) / size;
}
template <class F>
void parallel_blocks(std::size_t n, const F& f, std::size_t size = block_items) {
  parallel_items(n_blocks(n, size), 1, [&](std::size_t b) {
    const std::size_t begin = b * size;
    f(b, begin, begin + size < n ? begin + size : n);
  });
}

}  // namespace bb
