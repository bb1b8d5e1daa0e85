// A dot product whose order of additions does not depend on the number of threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/math/lanes.hpp"
#include "core/math/parallel.hpp"
#include "core/math/types.hpp"

namespace bb {

/// Dot products with partial sums over chunks of fixed size, added in the order of the chunks. A sum of a chunk waits for each of
/// its additions, so a task makes two side by side.
class ChunkedDot {
 public:
  double operator()(const VecXd& a, const VecXd& b) {
    const std::size_t n = static_cast<std::size_t>(a.size()), n_chunks = (n + chunk - 1) / chunk;
    partial_.resize(n_chunks + 1);  // the last of an odd number has an empty one beside it
    parallel_items((n_chunks + 1) / 2, 1, [&](std::size_t pair) {
      const std::size_t begin = 2 * pair * chunk;
      sum_two(a.data() + begin, b.data() + begin, n - begin, partial_.data() + 2 * pair);
    });
    double sum = 0;
    for (std::size_t c = 0; c < n_chunks; ++c) sum += partial_[c];
    return sum;
  }

 private:
  static constexpr std::size_t chunk = 8192;  // 64 KiB a vector: in cache

  /// Of n > 0 numbers, those from `chunk` on in the second sum.
  static void sum_two(const double* a, const double* b, std::size_t n, double* sums) {
    const std::size_t first = std::min(n, chunk), second = std::min(n - first, chunk);
    double low = a[0] * b[0], high = second > 0 ? a[chunk] * b[chunk] : 0.0;
    for (std::size_t i = 1; i < second; ++i) {
      low += a[i] * b[i];
      high += a[chunk + i] * b[chunk + i];
    }
    for (std::size_t i = std::max(second, std::size_t{1}); i < first; ++i) low += a[i] * b[i];
    sums[0] = low, sums[1] = high;
  }

  std::vector<double> partial_;
};

/// y += a x, number by number, and p = z + b p; four abreast.
inline void add_scaled(double a, const VecXd& x, VecXd& y) {
  const std::size_t n = static_cast<std::size_t>(y.size()), whole = n - n % 4;
  const Lanes<double, 4> factor(a);
  for (std::size_t i = 0; i < whole; i += 4) {
    store_lanes(load_lanes<4>(y.data() + i) + factor * load_lanes<4>(x.data() + i), y.data() + i);
  }
  for (std::size_t i = whole; i < n; ++i) y.data()[i] += a * x.data()[i];
}
inline void scale_and_add(double b, const VecXd& z, VecXd& p) {
  const std::size_t n = static_cast<std::size_t>(p.size()), whole = n - n % 4;
  const Lanes<double, 4> factor(b);
  for (std::size_t i = 0; i < whole; i += 4) {
    store_lanes(load_lanes<4>(z.data() + i) + factor * load_lanes<4>(p.data() + i), p.data() + i);
  }
  for (std::size_t i = whole; i < n; ++i) p.data()[i] = z.data()[i] + b * p.data()[i];
}

}  // namespace bb
