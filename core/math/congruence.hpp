// A B A^T of small matrices, of which Eigen makes a general product: one that nvcc has not on a card.
#pragma once

#include "core/math/types.hpp"

namespace bb {

/// A B A^T, B square. Host-device.
/// Its sums run in the order of their index.
template <class T, int N, int K>
BB_HD Mat<T, N, N> congruence(const Mat<T, N, K>& a, const Mat<T, K, K>& b) {
  Mat<T, N, N> out;
  for (int i = 0; i < N; ++i) {
    T row[K];
    for (int k = 0; k < K; ++k) {
      row[k] = a(i, 0) * b(0, k);
      for (int l = 1; l < K; ++l) row[k] += a(i, l) * b(l, k);
    }
    for (int j = 0; j < N; ++j) {
      T sum = row[0] * a(j, 0);
      for (int k = 1; k < K; ++k) sum += row[k] * a(j, k);
      out(i, j) = sum;
    }
  }
  return out;
}

}  // namespace bb
