// The mollifier of two edges (edge_edge_mollifier.hpp) for an edge and an infinite line with a unit direction: takes
// their contact to zero, C1, as the edge turns parallel to the line.
#pragma once

#include "core/geometry/edge_edge_mollifier.hpp"

namespace bb {

/// Threshold on |e x axis|^2 below which a pair is mollified: 1e-3 |e|^2 at rest, m^2, which is that of two edges where
/// the second one is a unit vector.
/// @param x_rest [3 x 2] e0 e1 at rest, m
template <class T>
BB_HD inline T edge_axis_mollifier_threshold(const Mat<T, 3, 2>& x_rest) {
  return T(1e-3) * (x_rest.col(1) - x_rest.col(0)).squaredNorm();
}

/// c = |e x axis|^2, m^2, from points across the axis.
/// @param points [3 x 3] a point of the axis, e0 e1, all without their part along the axis, m
template <class T>
BB_HD inline T edge_axis_cross_squared(const Mat<T, 3, 3>& points) {
  return (points.col(2) - points.col(1)).squaredNorm();
}

/// e(x) alone. eps: threshold, m^2, > 0.   Host-device.
template <class T>
BB_HD inline T edge_axis_mollifier_value(const Mat<T, 3, 3>& points, T eps) {
  return detail::MollifierTerms<T>(edge_axis_cross_squared<T>(points), eps).e;
}

}  // namespace bb
