// Loops over items that write their own slots: results do not depend on the number of threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace bb {

namespace detail {
/// Runs the items begin to end - 1 of the loop whose body is at f.
using RunItems = void (*)(const void* f, std::size_t begin, std::size_t end);
/// Calls run for parts of [0, n) on all threads; grain items or fewer are one part. Compiled once, in parallel.cpp: TBB's loop
/// takes the compiler a fifth of a second for every body that it is instantiated with.
void run_items(std::size_t n, std::size_t grain, const void* f, RunItems run);
}  // namespace detail

/// Calls f(i) for i in [0, n), in any order; grain items or fewer run as one task.
template <class Index, class F>
void parallel_items(Index n, std::size_t grain, const F& f) {
  if (n <= 0) return;
  detail::run_items(static_cast<std::size_t>(n), grain, &f,
                    [](const void* body, std::size_t begin, std::size_t end) {
                      const F& call = *static_cast<const F*>(body);
                      for (std::size_t i = begin; i != end; ++i) call(static_cast<Index>(i));
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

/// merge(...merge(merge(start, part 0), part 1)...), a part f(begin, end, start) of at least `grain` neighbouring items (but the
/// last); at most 1024 parts, so that many items need few results. Parts depend on n and grain alone.
template <class T, class F, class Merge>
T reduce_items(std::size_t n, std::size_t grain, const T& start, const F& f, const Merge& merge) {
  constexpr std::size_t most_parts = 1024;
  const std::size_t size = std::max(grain, n_blocks(n, most_parts));
  std::vector<T> parts(n_blocks(n, size), start);
  parallel_blocks(
      n, [&](std::size_t p, std::size_t begin, std::size_t end) { parts[p] = f(begin, end, start); }, size);
  T sum = start;
  for (const T& part : parts) sum = merge(sum, part);
  return sum;
}

}  // namespace bb
