// Axis-aligned boxes of primitives and of their motions, rounded outward.
#pragma once

#include <cmath>
#include <limits>

#include "core/math/types.hpp"

namespace bb {

/// Closed box [lo, hi], m. Empty until the first `add`.
struct Aabb {
  Vec3d lo = Vec3d::Constant(std::numeric_limits<double>::infinity());
  Vec3d hi = Vec3d::Constant(-std::numeric_limits<double>::infinity());

  void add(const Vec3d& p) {
    lo = lo.cwiseMin(p);
    hi = hi.cwiseMax(p);
  }
  void add(const Aabb& b) {
    lo = lo.cwiseMin(b.lo);
    hi = hi.cwiseMax(b.hi);
  }
  /// Grows by `margin` on every side and by what rounding may have lost: points of a swept segment are
  /// themselves rounded, as is the sum here; four units in the last place are more than both.
  void inflate(double margin) {
    constexpr double ulps = 4 * std::numeric_limits<double>::epsilon();
    constexpr double least = std::numeric_limits<double>::min();  // where an ulp is no fraction of the number
    for (int k = 0; k < 3; ++k) {
      lo[k] -= margin + (ulps * (std::abs(lo[k]) + margin) + least);
      hi[k] += margin + (ulps * (std::abs(hi[k]) + margin) + least);
    }
  }
  bool overlaps(const Aabb& b) const {
    return lo[0] <= b.hi[0] && b.lo[0] <= hi[0] && lo[1] <= b.hi[1] && b.lo[1] <= hi[1] && lo[2] <= b.hi[2] &&
           b.lo[2] <= hi[2];
  }
  /// Half the surface area, m^2.
  double half_area() const {
    const Vec3d e = hi - lo;
    return e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
  }
};

/// Distance between two boxes, m; 0 when they overlap. A lower bound of the distance of their contents.
inline double box_distance(const Aabb& a, const Aabb& b) {
  return (a.lo - b.hi).cwiseMax(b.lo - a.hi).cwiseMax(0.0).norm();
}

}  // namespace bb
