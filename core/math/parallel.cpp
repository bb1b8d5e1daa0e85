#include "core/math/parallel.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace bb::detail {

void run_items(std::size_t n, std::size_t grain, const void* f, RunItems run) {
  if (n <= grain) return run(f, 0, n);  // no task, and nothing is allocated for one
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, n, grain),
      [=](const tbb::blocked_range<std::size_t>& range) { run(f, range.begin(), range.end()); });
}

}  // namespace bb::detail
