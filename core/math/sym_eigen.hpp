// Eigenvalues and eigenvectors of small symmetric matrices: cyclic Jacobi rotations up to 4 x 4, tridiagonal
// QL beyond (up to about 12 x 12) and for lanes. Plain loops of bounded length, so that the device runs the same code; no
// library eigen-solver is called.
#pragma once

#include <cmath>
#include <limits>
#include <type_traits>

#include "core/math/scale.hpp"
#include "core/math/select.hpp"
#include "core/math/tridiagonal_eigen.hpp"
#include "core/math/types.hpp"

namespace bb {

/// Cosine, sine and tangent of the rotation that makes [app apq; apq aqq] diagonal, |angle| <= pi/4.
/// Requires apq != 0.   Source: Golub and Van Loan, Matrix Computations, 8.5.2.
template <class T>
struct JacobiRotation {
  T c, s, t;
  BB_HD JacobiRotation(T app, T apq, T aqq) {
    using std::abs, std::sqrt;
    const T tau = (aqq - app) / (T(2) * apq);  // infinite when apq is negligible: then t = 0
    t = select(tau < T(0), T(-1), T(1)) / (abs(tau) + sqrt(T(1) + tau * tau));
    c = T(1) / sqrt(T(1) + t * t);
    s = t * c;
  }
};

namespace detail {

/// Columns p and q of m become c p - s q and s p + c q where the mask holds.
template <class T, int R, int C>
BB_HD inline void rotate_columns(const MaskOf<T>& turn, Mat<T, R, C>& m, int p, int q, T c, T s) {
  for (int i = 0; i < R; ++i) {
    const T mp = m(i, p), mq = m(i, q);
    m(i, p) = select(turn, c * mp - s * mq, mp);
    m(i, q) = select(turn, s * mp + c * mq, mq);
  }
}

/// One rotation of the symmetric a that makes a(p, q) zero, where the mask holds.
template <class T, int N>
BB_HD inline void rotate_symmetric(const MaskOf<T>& turn, Mat<T, N, N>& a, int p, int q,
                                   const JacobiRotation<T>& r) {
  const T apq = a(p, q);
  a(p, p) = select(turn, a(p, p) - r.t * apq, a(p, p));
  a(q, q) = select(turn, a(q, q) + r.t * apq, a(q, q));
  a(p, q) = a(q, p) = select(turn, T(0), apq);
  for (int i = 0; i < N; ++i) {
    if (i == p || i == q) continue;
    const T aip = a(i, p), aiq = a(i, q);
    a(i, p) = a(p, i) = select(turn, r.c * aip - r.s * aiq, aip);
    a(i, q) = a(q, i) = select(turn, r.s * aip + r.c * aiq, aiq);
  }
}

/// Of two, lanes too.
template <class T>
BB_HD inline void sort_two(Vec<T, 2>& values, Mat<T, 2, 2>& vectors) {
  const MaskOf<T> swap = values[1] < values[0];
  const Vec<T, 2> low = vectors.col(0), high = vectors.col(1);
  const T first = values[0];
  values[0] = select(swap, values[1], first);
  values[1] = select(swap, first, values[1]);
  vectors.col(0) = select_entries(swap, high, low);
  vectors.col(1) = select_entries(swap, low, high);
}

template <class T, int N>
BB_HD inline void sort_ascending(Vec<T, N>& values, Mat<T, N, N>& vectors) {
  for (int i = 0; i + 1 < N; ++i) {
    int least = i;
    for (int j = i + 1; j < N; ++j) {
      if (values[j] < values[least]) least = j;
    }
    if (least == i) continue;
    const T value = values[i];
    values[i] = values[least];
    values[least] = value;
    for (int k = 0; k < N; ++k) {
      const T entry = vectors(k, i);
      vectors(k, i) = vectors(k, least);
      vectors(k, least) = entry;
    }
  }
}

/// Rotates a to diagonal form, its rotations into vectors; entries of a at most about 1.
/// Cost: 3 to 8 sweeps of N (N - 1) / 2 rotations, at most 16.
template <class T, int N>
BB_HD inline void jacobi_eigen(Mat<T, N, N>& a, Mat<T, N, N>& vectors) {
  using std::abs;
  using Scalar = typename ScalarOf<T>::type;
  constexpr Scalar eps = std::numeric_limits<Scalar>::epsilon();
  constexpr int max_sweeps = 16;  // convergence is quadratic
  // An entry is nothing when it is below rounding of both of its diagonal entries, or of rounding itself.
  constexpr Scalar relative_sq = eps * eps / 16;
  constexpr Scalar floor_sq = relative_sq * eps;
  vectors.setIdentity();
  MaskOf<T> rotated = true;
  for (int sweep = 0; sweep < max_sweeps && any(rotated); ++sweep) {
    const MaskOf<T> going = rotated;
    rotated = false;
    for (int p = 0; p < N; ++p) {
      for (int q = p + 1; q < N; ++q) {
        const T apq_sq = a(p, q) * a(p, q);
        const MaskOf<T> done = apq_sq <= T(floor_sq) || apq_sq <= T(relative_sq) * abs(a(p, p) * a(q, q));
        const MaskOf<T> turn = going && !done;
        if (!any(turn)) continue;
        const JacobiRotation<T> r(a(p, p), a(p, q), a(q, q));
        rotate_symmetric(turn, a, p, q, r);
        rotate_columns(turn, vectors, p, q, r.c, r.s);
        rotated = rotated || turn;
      }
    }
  }
}

}  // namespace detail

/// A = vectors diag(values) vectors^T of the symmetric part of A, the eigenvalues in no order. Of lanes never by Jacobi.
/// @param values  error a few eps of the largest |A_ij|; with N <= 4 of the value itself when A is well
/// scaled
/// @param vectors orthonormal columns (det +-1)
/// Errors: none for finite A; a non-finite A gives non-finite values.   Host-device; lanes too.
/// Cost: O(N^3); no allocation.
template <class T, int N, bool by_jacobi = N <= 4 && std::is_floating_point_v<T>>
BB_HD inline void eigen_unsorted(const Mat<T, N, N>& A, Vec<T, N>& values, Mat<T, N, N>& vectors) {
  const T unit = power_of_two_scale(A);
  const T half = T(0.5) / unit;  // exact
  Mat<T, N, N> a;
  for (int j = 0; j < N; ++j) {
    for (int i = j; i < N; ++i) a(i, j) = a(j, i) = A(i, j) * half + A(j, i) * half;
  }
  if constexpr (by_jacobi) {
    detail::jacobi_eigen<T, N>(a, vectors);
    values = a.diagonal();
  } else {
    detail::tridiagonal_eigen<T, N>(a, values, vectors);
  }
  values *= unit;
}

/// eigen_unsorted with the eigenvalues ascending. Lanes, with the bits of one number: N = 2 alone.
template <class T, int N>
BB_HD inline void sym_eigen(const Mat<T, N, N>& A, Vec<T, N>& values, Mat<T, N, N>& vectors) {
  eigen_unsorted<T, N, N <= 4>(A, values, vectors);
  if constexpr (N == 2) {
    detail::sort_two(values, vectors);
  } else {
    detail::sort_ascending(values, vectors);
  }
}

}  // namespace bb
