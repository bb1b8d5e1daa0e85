// Singular value decomposition of 2x2, 3x3 (rotation variant) and 3x2 matrices by one-sided Jacobi rotations,
// which never form F^T F: small singular values keep their digits, in float too.
#pragma once

#include <cmath>
#include <limits>

#include "core/math/products.hpp"
#include "core/math/scale.hpp"
#include "core/math/sym_eigen.hpp"
#include "core/math/types.hpp"

namespace bb {

/// F = U diag(sigma) V^T.
template <class T, int M, int N>
struct Svd {
  Mat<T, M, N> U;   // orthonormal columns
  Vec<T, N> sigma;  // descending in absolute value
  Mat<T, N, N> V;   // rotation
};
template <class T>
using Svd22 = Svd<T, 2, 2>;
template <class T>
using Svd32 = Svd<T, 3, 2>;
template <class T>
using Svd33 = Svd<T, 3, 3>;

namespace detail {

/// Rotates the columns of w (and of v) until they are orthogonal relative to their own lengths, the longest
/// first: w = F V with V a rotation. Source: Hestenes 1958; order of columns by de Rijk 1989.
template <class T, int M, int N>
BB_HD inline void orthogonalise_columns(Mat<T, M, N>& w, Mat<T, N, N>& v) {
  using std::abs, std::sqrt;
  const T eps(std::numeric_limits<typename ScalarOf<T>::type>::epsilon());
  constexpr int max_sweeps = 20;  // 3 to 6 are usual; graded matrices need a few more
  v.setIdentity();
  MaskOf<T> rotated = true;
  for (int sweep = 0; sweep < max_sweeps && any(rotated); ++sweep) {
    const MaskOf<T> going = rotated;
    rotated = false;
    for (int p = 0; p < N; ++p) {
      for (int q = p + 1; q < N; ++q) {
        const MaskOf<T> swap = going && w.col(p).squaredNorm() < w.col(q).squaredNorm();
        if (any(swap)) {  // a quarter turn: swaps, stays a rotation
          rotate_columns(swap, w, p, q, T(0), T(-1));
          rotate_columns(swap, v, p, q, T(0), T(-1));
          rotated = rotated || swap;  // pairs seen before in this sweep are others now
        }
        const T pp = w.col(p).squaredNorm(), qq = w.col(q).squaredNorm(), pq = w.col(p).dot(w.col(q));
        const MaskOf<T> turn = going && abs(pq) > eps * sqrt(pp) * sqrt(qq);
        if (!any(turn)) continue;
        const JacobiRotation<T> r(pp, pq, qq);
        rotate_columns(turn, w, p, q, r.c, r.s);
        rotate_columns(turn, v, p, q, r.c, r.s);
        rotated = rotated || turn;
      }
    }
  }
}

/// A unit vector at a right angle to the unit vector u: beside the axis in which u is shortest, the first of these.
template <class T>
BB_HD inline Vec<T, 3> any_perpendicular(const Vec<T, 3>& u) {
  using std::abs, std::sqrt;
  const T size[] = {abs(u[0]), abs(u[1]), abs(u[2])};
  const MaskOf<T> second = size[1] < size[0], third = size[2] < select(second, size[1], size[0]);
  const Vec<T, 3> axis(select(second || third, T(0), T(1)), select(second && !third, T(1), T(0)),
                       select(third, T(1), T(0)));
  const Vec<T, 3> n = accurate_cross(u, axis);
  const T length_sq = n.squaredNorm();
  const Vec<T, 3> unit = n / sqrt(length_sq);
  return select_entries(length_sq > T(0), unit, n);
}

/// w / |w|, or the fallback for a zero vector; length receives |w|.
template <class T, int M>
BB_HD inline Vec<T, M> direction_or(const Vec<T, M>& w, const Vec<T, M>& fallback, T& length) {
  length = w.norm();
  const Vec<T, M> unit = w / length;
  return select_entries(length > T(0), unit, fallback);
}

}  // namespace detail

/// Rotation variant: det U = det V = 1, sigma_0 >= |sigma_1|, the sign of det F on sigma_1.
/// Both singular values to a few eps of themselves; factors orthonormal for every finite F, zero included.
/// Errors: none; a non-finite F gives non-finite factors.   Host-device.
template <class T>
BB_HD inline Svd22<T> svd_2x2(const Mat<T, 2, 2>& F) {
  const T scale = power_of_two_scale(F);
  const Mat<T, 2, 2> unit = F / scale;
  Mat<T, 2, 2> w = unit;
  Svd22<T> out;
  detail::orthogonalise_columns(w, out.V);
  const Vec<T, 2> first = w.col(0), axis(1, 0);
  T s0;
  const Vec<T, 2> u = detail::direction_or(first, axis, s0);
  out.U << u[0], -u[1], u[1], u[0];
  const T det = difference_of_products(unit(0, 0), unit(1, 1), unit(0, 1), unit(1, 0));
  T s1 = s0 > 0 ? det / s0 : T(0);
  s1 = s1 > s0 ? s0 : (s1 < -s0 ? -s0 : s1);
  out.sigma << s0 * scale, s1 * scale;
  return out;
}

/// U 3x2 with orthonormal columns, sigma_0 >= sigma_1 >= 0, V 2x2 with det V = 1.
/// Both singular values to a few eps of themselves; factors orthonormal for every finite F, zero included.
/// Errors: none; a non-finite F gives non-finite factors.   Host-device, lanes.
template <class T>
BB_HD inline Svd32<T> svd_3x2(const Mat<T, 3, 2>& F) {
  const T scale = power_of_two_scale(F);
  const Mat<T, 3, 2> unit = F / scale;
  Mat<T, 3, 2> w = unit;
  Svd32<T> out;
  detail::orthogonalise_columns(w, out.V);
  const Vec<T, 3> first = w.col(0), second = w.col(1), axis(1, 0, 0);
  T s0, s1;
  const Vec<T, 3> u0 = detail::direction_or(first, axis, s0);
  out.U.col(0) = u0;
  out.U.col(1) = detail::direction_or(second, detail::any_perpendicular(u0), s1);
  const Vec<T, 3> f0 = unit.col(0), f1 = unit.col(1);
  s1 = select(s0 > T(0), accurate_cross(f0, f1).norm() / s0, T(0));  // the area is the product of both
  out.sigma << s0 * scale, select(s1 > s0, s0, s1) * scale;
  return out;
}

/// Rotation variant: det U = det V = 1, sigma_0 >= sigma_1 >= |sigma_2|, the sign of det F on sigma_2.
/// Singular values to a few eps of sigma_0, better when F is a scaled orthogonal basis; factors
/// orthonormal for every finite F, zero and rank 1 included. Errors: none; a non-finite F gives
/// non-finite factors. Host-device.
template <class T>
BB_HD inline Svd33<T> svd_3x3(const Mat<T, 3, 3>& F) {
  const T scale = power_of_two_scale(F);
  Mat<T, 3, 3> w = F / scale;
  Svd33<T> out;
  detail::orthogonalise_columns(w, out.V);
  const Vec<T, 3> first = w.col(0), second = w.col(1), axis(1, 0, 0);
  T s0, s1;
  const Vec<T, 3> u0 = detail::direction_or(first, axis, s0);
  const Vec<T, 3> u1 = detail::direction_or(second, detail::any_perpendicular(u0), s1);
  const Vec<T, 3> u2 = accurate_cross(u0, u1);
  out.U << u0, u1, u2;
  s1 = s1 > s0 ? s0 : s1;  // ties keep their order whatever the rounding
  T s2 = u2.dot(w.col(2));
  s2 = s2 > s1 ? s1 : (s2 < -s1 ? -s1 : s2);
  out.sigma << s0 * scale, s1 * scale, s2 * scale;
  return out;
}

}  // namespace bb
