// The time at which ONE candidate pair or obstacle contact stops a motion: cheap certificates of separation
// first, then ACCD or the exact root.
#pragma once

#include <algorithm>
#include <limits>

#include "core/contact/obstacle.hpp"
#include "core/contact/pair_geometry.hpp"
#include "core/geometry/accd.hpp"

namespace bb {

/// Smallest stop level that means anything: 16 ulps of the largest coordinate, m (docs/design.md).
inline double ulp_floor(double largest) { return 16 * std::numeric_limits<double>::epsilon() * largest; }

/// A distance of the pair, m, that is above its stop level and the rounding of the tests below.
template <PairKind K>
double distance_needed(const Mat<double, 3, pair_points(K)>& x0, const Mat<double, 3, pair_points(K)>& x1,
                       double offset, double park) {
  const double largest = std::max({x0.cwiseAbs().maxCoeff(), x1.cwiseAbs().maxCoeff(), offset});
  return offset + 2 * std::max(park, ulp_floor(largest));
}

/// True when the boxes of the two primitives prove that the pair stays above its stop level.
template <PairKind K>
bool proven_apart(const Mat<double, 3, pair_points(K)>& x0, const Mat<double, 3, pair_points(K)>& x1,
                  double offset, double park) {
  const double needed = distance_needed<K>(x0, x1, offset, park);
  const double apart = pair_box_distance<K>(x0);
  if (!(apart > needed)) return false;
  // what the first primitive's box loses is at most the largest displacement relative to the second
  const Mat<double, 3, pair_points(K)> dx = x1 - x0;
  return apart - detail::relative_speed<K, double>(dx) > needed || pair_box_distance<K>(x0, x1) > needed;
}

/// accd() of a pair. Where a plane at time 0 proves that its speed bound reaches time 1, that is what accd()
/// returns after one probe, and it is returned without the probe.
template <PairKind K>
AccdResult<double> pair_toi(const Mat<double, 3, pair_points(K)>& x0,
                            const Mat<double, 3, pair_points(K)>& x1, double offset, double park,
                            int max_probes) {
  const Mat<double, 3, pair_points(K)> dx = x1 - x0;
  const double loss = detail::relative_speed<K, double>(dx);
  if (farther_than<K>(x0, distance_needed<K>(x0, x1, offset, park) + loss))
    return {1, false, 1, false, false};
  return accd<K, double>(x0, x1, offset, park, max_probes);
}

/// Time in [0, 1] at which a vertex comes down to the stop level over an obstacle; stop levels as for ACCD.
inline double obstacle_toi(const AnalyticSurface<double>& obstacle, const Vec3d& x0, const Vec3d& x1,
                           double offset, double park) {
  const double start = surface_gap<double>(obstacle, x0).d - offset;
  const double largest = std::max({x0.cwiseAbs().maxCoeff(), x1.cwiseAbs().maxCoeff(),
                                   obstacle.point.cwiseAbs().maxCoeff(), obstacle.radius, offset});
  const double floor = ulp_floor(largest);
  if (!(start > floor)) return 0;
  const double stop = std::max(park, floor);
  return first_time_at<double>(obstacle, x0, x1, offset + (start < 2 * stop ? start / 2 : stop));
}

}  // namespace bb
