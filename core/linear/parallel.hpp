// A dot product whose order of additions does not depend on the number of threads.
#pragma once

#include <algorithm>
#include <vector>

#include "core/math/parallel.hpp"
#include "core/math/types.hpp"

namespace bb {

/// Dot products with partial sums over chunks of fixed size, added in the order of the chunks.
class ChunkedDot {
 public:
  double operator()(const VecXd& a, const VecXd& b) {
    const Eigen::Index n = a.size();
    const int n_chunks = static_cast<int>((n + kChunk - 1) / kChunk);
    partial_.assign(static_cast<std::size_t>(n_chunks), 0.0);
    parallel_items(n_chunks, 1, [&](int c) {
      const Eigen::Index begin = c * kChunk, length = std::min(kChunk, n - begin);
      partial_[static_cast<std::size_t>(c)] = a.segment(begin, length).dot(b.segment(begin, length));
    });
    double sum = 0;
    for (const double p : partial_) sum += p;
    return sum;
  }

 private:
  static constexpr Eigen::Index kChunk = 8192;  // 64 KiB a vector: in cache, and worth a task
  std::vector<double> partial_;
};

}  // namespace bb
