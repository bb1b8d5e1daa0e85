// Parallel loops over chunks of fixed size, so that what is gathered chunk by chunk does not depend on the
// number of threads.
#pragma once

#include <cstddef>
#include <vector>

#include "core/math/parallel.hpp"

namespace bb {

constexpr std::size_t chunk_size = 512;  // pairs; about 0.1 ms of work

constexpr std::size_t n_chunks(std::size_t n) { return n_blocks(n, chunk_size); }

/// Calls f(chunk, begin, end) for every chunk of [0, n), in parallel.
template <class F>
void for_each_chunk(std::size_t n, const F& f) {
  parallel_blocks(n, f, chunk_size);
}

/// Runs add(item, result) over all items in chunks and reduce(result) over the chunks in order.
template <class Result, class Items, class Add, class Reduce>
void over_chunks(const Items& items, const Add& add, const Reduce& reduce) {
  std::vector<Result> results(n_chunks(items.size()));
  for_each_chunk(items.size(), [&](std::size_t k, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) add(items[i], results[k]);
  });
  for (const Result& r : results) reduce(r);
}

}  // namespace bb
