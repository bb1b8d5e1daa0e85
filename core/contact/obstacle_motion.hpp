// The time at which ONE obstacle contact stops a motion, and the least stop level of any contact.
#pragma once

#include <limits>
#include <type_traits>

#include "core/contact/obstacle.hpp"

namespace bb {

/// Smallest stop level that means anything: 16 ulps of the largest coordinate, m (docs/theory/newton.md).
template <class T>
BB_HD T ulp_floor(T largest) {
  return 16 * std::numeric_limits<T>::epsilon() * largest;
}

/// Time in [0, 1] at which a vertex comes down to the stop level over an obstacle that goes straight from `obstacle` to
/// `end`; stop levels as for ACCD.
template <class T>
BB_HD T obstacle_toi(const AnalyticSurface<T>& obstacle, const AnalyticSurface<T>& end,
                     const std::type_identity_t<Vec<T, 3>>& x0, const std::type_identity_t<Vec<T, 3>>& x1,
                     std::type_identity_t<T> offset, std::type_identity_t<T> park) {
  const T start = surface_gap<T>(obstacle, x0).d - offset;
  const T sizes[] = {x1.cwiseAbs().maxCoeff(), obstacle.point.cwiseAbs().maxCoeff(),
                     end.point.cwiseAbs().maxCoeff(), obstacle.radius, offset};
  T largest = x0.cwiseAbs().maxCoeff();
  for (const T size : sizes) largest = largest < size ? size : largest;
  const T floor = ulp_floor(largest);
  if (!(start > floor)) return 0;
  const T stop = park < floor ? floor : park;
  return first_time_at<T>(obstacle, end, x0, x1, offset + (start < 2 * stop ? start / 2 : stop));
}

}  // namespace bb
