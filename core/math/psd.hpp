// Small symmetric matrices made positive semi-definite: their negative eigenvalues are set to zero, or change
// sign. Used for element and contact Hessians before assembly.
#pragma once

#include <cmath>

#include "core/math/projection.hpp"
#include "core/math/sym_eigen.hpp"
#include "core/math/types.hpp"

namespace bb {

/// True when Cholesky's pivots of the lower triangle of A are all positive: then no eigenvalue
/// is below rounding.
template <class T, int N>
BB_HD inline MaskOf<T> has_positive_pivots(const Mat<T, N, N>& A) {
  using std::sqrt;
  Mat<T, N, N> l;
  MaskOf<T> positive = true;
  for (int j = 0; j < N; ++j) {
    T pivot = A(j, j);
    for (int k = 0; k < j; ++k) pivot -= l(j, k) * l(j, k);
    positive = positive && pivot > T(0);
    if (!any(positive)) break;
    const T root = sqrt(pivot);
    for (int i = j + 1; i < N; ++i) {
      T entry = A(i, j);
      for (int k = 0; k < j; ++k) entry -= l(i, k) * l(j, k);
      l(i, j) = entry / root;
    }
  }
  return positive;
}

/// The symmetric matrix A = V Lambda V^T with its eigenvalues projected; psd gives the nearest positive
/// semi-definite matrix in the Frobenius norm.
/// @param n_negative  when not null: how many eigenvalues were negative (those of rounding size included); of
///                    lanes: how many of the N were so in any; 0 with Projection::none
/// @return            A itself, bit for bit, when none was
/// Errors: none.   Host-device, lanes.   Cost: N^3/6 when A is positive definite, else sym_eigen.
/// Source: Higham 1988, Computing a nearest symmetric positive semidefinite matrix.
template <class T, int N>
BB_HD inline Mat<T, N, N> project(const Mat<T, N, N>& A, Projection projection, int* n_negative = nullptr) {
  if (n_negative != nullptr) *n_negative = 0;
  Mat<T, N, N> out = A;  // returned by name: nvcc 13.0 leaves entries of a returned parameter unset at N = 9
  if (projection == Projection::none) return out;
  const MaskOf<T> positive = has_positive_pivots<T, N>(A);
  if (!any(!positive)) return out;
  Vec<T, N> values;
  Mat<T, N, N> vectors;
  eigen_unsorted<T, N>(A, values, vectors);
  MaskOf<T> keep = true;
  out = Mat<T, N, N>::Zero();
  for (int k = 0; k < N; ++k) {
    const MaskOf<T> negative = values[k] < T(0) && !positive;
    if (any(negative) && n_negative != nullptr) ++*n_negative;
    keep = keep && !negative;
    const T value = project_eigenvalue(values[k], projection);
    if (!any(!(value == T(0)))) continue;
    for (int j = 0; j < N; ++j) {
      const T scaled = value * vectors(j, k);
      for (int i = j; i < N; ++i) out(i, j) += scaled * vectors(i, k);
    }
  }
  for (int j = 0; j < N; ++j) {
    for (int i = j; i < N; ++i) {
      out(i, j) = select(keep, A(i, j), out(i, j));
      out(j, i) = select(keep, A(j, i), out(i, j));
    }
  }
  return out;
}

/// project() of a symmetric A with A u = 0, done on the complement of u. To rounding, also when no
/// eigenvalue is negative. u != 0 of any length whose square is a normal number. Host-device, lanes.   Cost:
/// that of project() at N - 1, and 8 N^2.
template <class T, int N>
BB_HD inline Mat<T, N, N> project_beside(const Mat<T, N, N>& A, const Vec<T, N>& u, Projection projection) {
  const T length = u.norm();
  Vec<T, N> v = u;  // the reflection takes u to the first axis
  v[0] += select(u[0] < T(0), -length, length);
  const T beta = T(2) / v.squaredNorm();
  Mat<T, N, N> turned = A;
  detail::reflect_symmetric<T, N>(0, v, beta, turned);
  Mat<T, N, N> out = Mat<T, N, N>::Zero();
  out.template bottomRightCorner<N - 1, N - 1>() =
      project<T, N - 1>(turned.template bottomRightCorner<N - 1, N - 1>(), projection);
  detail::reflect_symmetric<T, N>(0, v, beta, out);
  return out;
}

}  // namespace bb
