// Axis-aligned boxes of single primitives; those of the trees are in tree_box.hpp.
#pragma once

#include <limits>

#include "core/math/types.hpp"

namespace bb {

/// Closed box [lo, hi], m. Empty until the first `add`.
struct Aabb {
  Vec3d lo = Vec3d::Constant(std::numeric_limits<double>::infinity());
  Vec3d hi = Vec3d::Constant(-std::numeric_limits<double>::infinity());

  BB_HD void add(const Vec3d& p) {
    lo = lo.cwiseMin(p);
    hi = hi.cwiseMax(p);
  }
};

/// Distance between two boxes, m; 0 when they overlap. A lower bound of the distance of their contents.
BB_HD inline double box_distance(const Aabb& a, const Aabb& b) {
  return (a.lo - b.hi).cwiseMax(b.lo - a.hi).cwiseMax(0.0).norm();
}

}  // namespace bb
