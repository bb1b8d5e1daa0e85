// The time at which ONE obstacle contact stops a motion, and the least stop level of any contact.
#pragma once

#include <algorithm>
#include <limits>

#include "core/contact/obstacle.hpp"

namespace bb {

/// Smallest stop level that means anything: 16 ulps of the largest coordinate, m (docs/design.md).
inline double ulp_floor(double largest) { return 16 * std::numeric_limits<double>::epsilon() * largest; }

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
