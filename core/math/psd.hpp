// The nearest positive semi-definite matrix: negative eigenvalues of a small symmetric matrix are set to
// zero. Used for element and contact Hessians before assembly.
#pragma once

#include <cmath>

#include "core/math/sym_eigen.hpp"
#include "core/math/types.hpp"

namespace bb {

/// True when Cholesky's pivots of the lower triangle of A are all positive: then no eigenvalue is below
/// rounding.
template <class T, int N>
BB_HD inline bool has_positive_pivots(const Mat<T, N, N>& A) {
  using std::sqrt;
  Mat<T, N, N> l;
  for (int j = 0; j < N; ++j) {
    T pivot = A(j, j);
    for (int k = 0; k < j; ++k) pivot -= l(j, k) * l(j, k);
    if (!(pivot > 0)) return false;
    const T root = sqrt(pivot);
    for (int i = j + 1; i < N; ++i) {
      T entry = A(i, j);
      for (int k = 0; k < j; ++k) entry -= l(i, k) * l(j, k);
      l(i, j) = entry / root;
    }
  }
  return true;
}

/// V max(Lambda, 0) V^T of the symmetric matrix A = V Lambda V^T, the nearest in the Frobenius norm.
/// @param n_clamped  when not null: how many eigenvalues were negative (those of rounding size included)
/// @return           A itself, bit for bit, when none was
/// Errors: none.   Host-device.   Cost: N^3/6 when A is positive definite, else sym_eigen.
/// Source: Higham 1988, Computing a nearest symmetric positive semidefinite matrix.
template <class T, int N>
BB_HD inline Mat<T, N, N> project_psd(const Mat<T, N, N>& A, int* n_clamped = nullptr) {
  if (n_clamped != nullptr) *n_clamped = 0;
  if (has_positive_pivots(A)) return A;
  Vec<T, N> values;
  Mat<T, N, N> vectors;
  sym_eigen<T, N>(A, values, vectors);
  int n_negative = 0;
  while (n_negative < N && values[n_negative] < 0) ++n_negative;
  if (n_clamped != nullptr) *n_clamped = n_negative;
  if (n_negative == 0) return A;

  Mat<T, N, N> out;
  for (int j = 0; j < N; ++j) {
    for (int i = j; i < N; ++i) {
      T sum = 0;
      for (int k = n_negative; k < N; ++k) sum += values[k] * vectors(i, k) * vectors(j, k);
      out(i, j) = out(j, i) = sum;
    }
  }
  return out;
}

}  // namespace bb
