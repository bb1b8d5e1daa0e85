// How the gap of a contact row goes along a straight motion, to second order, and what keeps a step from losing it. One
// code for the rows of the host and in kernels; host-device, no allocation.
#pragma once

#include <limits>

#include "core/contact/row_hessian.hpp"

namespace bb {

/// d(x + t dx) = d + t slope - t^2 loss.
struct GapAlong {
  double slope;  // grad d . dx, m
  double
      loss;  // -dx^T grad^2 d dx / 2, m: an edge that rolls over a ball comes closer to it than its slope says

  /// When half of the gap d is gone; infinity: never; 0 without a gap.
  BB_HD double half_time(double d) const {
    using std::sqrt;
    if (!(d > 0)) return 0;
    const double spread = slope * slope + 2 * loss * d;
    if (spread >= 0 && slope < 0) return d / (sqrt(spread) - slope);
    if (loss > 0) return (slope + sqrt(spread)) / (2 * loss);
    return std::numeric_limits<double>::infinity();
  }
  /// Whether curvature has taken most of it at that time.
  BB_HD bool curved(double d) const {
    const double t = half_time(d);
    return loss > 0 && t * t * loss > d / 4 && d > 0;
  }
  /// What the gap at the end of the motion lacks, m, to be what the slope says, and no less than half of d.
  BB_HD double missing(double d) const {
    const double straight = d + slope, wanted = straight > d / 2 ? straight : d / 2;
    const double lacks = wanted - (straight - loss);
    return lacks > 0 ? lacks : 0;
  }
};

/// When rows hold a motion: the first half_time() of those that are curved, and of the others.
struct HoldTimes {
  double curved = std::numeric_limits<double>::infinity(), straight = curved;

  BB_HD void add(double d, const GapAlong& gap) {
    double& first = gap.curved(d) ? curved : straight;
    const double t = gap.half_time(d);
    first = t < first ? t : first;
  }
  /// Whether curvature is what stops a motion at `bound`: a pair without a row may be earlier.
  bool by_curvature(double bound) const { return curved < straight && curved < 2 * bound; }
};

/// Of a row whose closest points slide along F edges. dx: of the points of row.w and row.g, 0 where there is none, m.
template <int F>
BB_HD inline GapAlong gap_along(const RowShape<double, F>& row, const Mat<double, 3, 4>& dx) {
  const Vec3d moved = dx * row.w;
  double second = 0;
  for (int l = 0; l < F; ++l) {
    const double turn = row.n.dot(dx * row.g[l]);
    second -= turn * (2 * row.q[l].dot(moved) + row.distance * turn);
  }
  if constexpr (F == 1) {
    const double aside = row.n.cross(row.q[0]).dot(moved);
    second += row.bend / row.distance * aside * aside;
  }
  return {row.n.dot(moved), -second / 2};
}

/// Of one whose closest points slide nowhere; curvature and flat as in fixed_points_block(), moved = sum w_i dx_i, m.
BB_HD inline GapAlong gap_along(const Vec3d& n, const Vec3d& flat, double curvature, const Vec3d& moved) {
  const double slope = n.dot(moved), flown = flat.dot(moved);
  return {slope, -curvature * (moved.squaredNorm() - slope * slope - flown * flown) / 2};
}

}  // namespace bb
