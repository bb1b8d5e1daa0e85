// The local frame of the row of an edge or a triangle outside a sphere or a cylinder. Host-device, no allocation.
#pragma once

#include "core/contact/row_hessian.hpp"
#include "core/geometry/distance_derivatives.hpp"

namespace bb {

/// Of n, q, g (of the vertices in their order, given ones too), distance and bend; w, stretch and push are left at 0.
/// @param x [3 x N] the vertices of the row, m
/// @param axis of a cylinder, unit; 0: a sphere
/// @param n unit normal; @param distance of the closest point from the centre or the axis, m
template <int N, class T>
BB_HD inline RowShape<T, N - 1> obstacle_shape(const Mat<T, 3, N>& x, const Vec<T, 3>& axis,
                                               const Vec<T, 3>& n, T distance) {
  // The frame is made of differences of vertices: where the centre is does not count.
  Mat<T, 3, N + 1> points;
  points.col(0).setZero();
  for (int k = 0; k < N; ++k) {
    const Vec<T, 3> from_first = x.col(k) - x.col(0);
    points.col(k + 1) = from_first - axis.dot(from_first) * axis;
  }
  Closest<T, N + 1> closest;
  closest.weights.setZero();
  closest.d = distance;
  closest.r = distance * n;
  closest.region = N == 2 ? Region::p_e : Region::p_t;
  const auto frame = detail::region_frame<T, N + 1>(points, closest);
  RowShape<T, N - 1> out;
  out.w.setZero();
  out.n = frame.n;
  for (int l = 0; l < N - 1; ++l) {
    out.q[l] = frame.q[l];
    out.g[l].setZero();
    for (int k = 0; k < N; ++k) out.g[l][k] = frame.g[l][k + 1];
  }
  out.distance = distance;
  out.stretch = out.push = 0;
  out.bend = axis.squaredNorm() > 0 ? T(0) : T(1);
  return out;
}

}  // namespace bb
