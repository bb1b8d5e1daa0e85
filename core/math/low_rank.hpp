// Projection of symmetric matrices most of whose eigenvalues may be zero, from their numbers alone: the reduction to a
// tridiagonal matrix stops where nothing is left to reduce. Host only, lanes.
#pragma once

#include <limits>

#include "core/math/psd.hpp"

namespace bb {
namespace detail {

/// Rows from `first`, that of r.v, on of all columns of q, reflected. tridiagonalise() has this loop in place: nvcc
/// 13.0 leaves entries of its q unset at N = 9 when it calls this function (DeviceCheck.EigenvaluesAndProjection).
template <class T, int N, int C>
inline void reflect_columns(int first, const Reflection<T, N>& r, Mat<T, N, C>& q) {
  for (int j = 0; j < C; ++j) {
    T sum(0);
    for (int i = first; i < N; ++i) sum += r.v[i] * q(i, j);
    sum *= r.beta;
    for (int i = first; i < N; ++i) q(i, j) -= sum * r.v[i];
  }
}

/// The leading rows of the tridiagonal form of a: what lies beyond them, and couples to them, is rounding. A matrix of
/// rank r has at most r + 1 unless its first entries are zero.
template <class T, int N>
struct LeadingRows {
  Vec<T, N> d = Vec<T, N>::Zero(), e = Vec<T, N>::Zero();
  Reflection<T, N> reflections[N];
  int n = 0;

  /// a: symmetric, largest entry about 1; destroyed.
  explicit LeadingRows(Mat<T, N, N>& a) {
    for (; n < N; ++n) {
      const MaskOf<T> done = is_rounding(a);
      if (n > 0) e[n - 1] = select(done, T(0), e[n - 1]);
      if (!any(!done)) return;
      d[n] = select(done, T(0), a(n, n));
      if (n + 1 == N) continue;
      Reflection<T, N>& r = reflections[n] = Reflection<T, N>(a, n);  // of the last two rows: none
      r.beta = select(done, T(0), r.beta);
      e[n] = select(done, T(0), r.target);
      if (any(!(r.beta == T(0)))) reflect_symmetric<T, N>(n + 1, r.v, r.beta, a);
    }
  }

  /// Whether the rows from n on, and e[n - 1], are at most 64 eps in the Frobenius norm; false for NaN.
  MaskOf<T> is_rounding(const Mat<T, N, N>& a) const {
    const T eps(std::numeric_limits<typename ScalarOf<T>::type>::epsilon());
    T beside = n > 0 ? e[n - 1] * e[n - 1] : T(0), diagonal(0);
    for (int j = n; j < N; ++j) {
      diagonal += a(j, j) * a(j, j);
      for (int i = j + 1; i < N; ++i) beside += a(i, j) * a(i, j);
    }
    return diagonal + T(2) * beside <= T(4096) * eps * eps;
  }
};

/// The matrix whose leading rows these are, at most K of them, with projected eigenvalues; times `unit`.
template <int K, class T, int N>
inline Mat<T, N, N> project_rows(const LeadingRows<T, N>& rows, T unit, Projection projection) {
  Vec<T, K> d = rows.d.template head<K>(), e = rows.e.template head<K>();
  Mat<T, K, K> turned = Mat<T, K, K>::Identity();
  ql_iterate<T, K>(d, e, turned);
  Mat<T, N, K> vectors = Mat<T, N, K>::Zero();
  vectors.template topRows<K>() = turned;
  for (int k = rows.n - 1; k >= 0; --k) reflect_columns<T, N, K>(k + 1, rows.reflections[k], vectors);
  Mat<T, N, N> out = Mat<T, N, N>::Zero();
  for (int k = 0; k < K; ++k) {
    const T value = unit * project_eigenvalue(d[k], projection);
    if (!any(!(value == T(0)))) continue;
    for (int j = 0; j < N; ++j) {
      const T scaled = value * vectors(j, k);
      for (int i = j; i < N; ++i) out(i, j) += scaled * vectors(i, k);
    }
  }
  for (int j = 0; j < N; ++j) {
    for (int i = j + 1; i < N; ++i) out(j, i) = out(i, j);
  }
  return out;
}

}  // namespace detail

/// project() of a symmetric A, within 128 eps |A| in the Frobenius norm beside the rounding of project(); to rounding, also
/// when no eigenvalue is negative. K: rows up to which the small form is used; beyond it costs what project() does.
/// Errors: none; a non-finite A gives non-finite numbers.   Cost: about 6 r N^2 for rank r < K.
template <int K, class T, int N>
inline Mat<T, N, N> project_low_rank(const Mat<T, N, N>& A, Projection projection) {
  const T unit = power_of_two_scale(A);
  Mat<T, N, N> a = A * (T(1) / unit);
  const detail::LeadingRows<T, N> rows(a);
  if (rows.n <= K) return detail::project_rows<K>(rows, unit, projection);
  return detail::project_rows<N>(rows, unit, projection);
}

}  // namespace bb
