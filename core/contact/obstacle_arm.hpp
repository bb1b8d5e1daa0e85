// Where the surface of an obstacle is at a contact, seen from its point: what its turn takes along.
#pragma once

#include "core/contact/obstacle.hpp"

namespace bb {

/// From the point of an obstacle to its surface in the direction of another side, m. arm: to that side, m. Host-device.
template <class T>
BB_HD inline Vec<T, 3> arm_to_surface(const AnalyticSurface<T>& o, const Vec<T, 3>& arm) {
  if (o.kind == ObstacleKind::plane) return arm - o.axis.dot(arm) * o.axis;
  Vec<T, 3> along = Vec<T, 3>::Zero();
  if (o.kind == ObstacleKind::cylinder) along = o.axis.dot(arm) * o.axis;
  const Vec<T, 3> across = arm - along;
  return along + o.radius * across.normalized();
}

/// What a turn takes the surface along by, m, which is at `arm` when the obstacle has turned by `turned`: to `end` from `begin`.
template <class T>
BB_HD inline Vec<T, 3> way_of_turn(const Vec<T, 3>& arm, const Mat<T, 3, 3>& turned,
                                   const Mat<T, 3, 3>& begin, const Mat<T, 3, 3>& end) {
  const Vec<T, 3> unturned = turned.transpose() * arm;
  const Vec<T, 3> to = end * unturned, from = begin * unturned;
  return to - from;
}

}  // namespace bb
