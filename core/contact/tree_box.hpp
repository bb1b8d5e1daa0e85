// Axis-aligned boxes in float, as the trees keep them: half the memory of double and twice the lanes of a vector.
#pragma once

#include <algorithm>
#include <limits>

#include "core/contact/float_rounding.hpp"
#include "core/math/lanes.hpp"
#include "core/math/types.hpp"

namespace bb {

/// Closed box [lo, hi], m. Empty until the first `add`. The fourth lane holds nothing.
struct TreeBox {
  using Four = VectorOf<float, 4>::type;
  Four lo = std::numeric_limits<float>::infinity() - Four{};
  Four hi = -std::numeric_limits<float>::infinity() - Four{};

  /// Adds the point and all that is within `margin` (m, >= 0, an axis each) of it, rounded outward.
  void add(const Vec3d& p, const Vec3d& margin = Vec3d::Zero()) {
    constexpr float largest = std::numeric_limits<float>::max();  // beyond it, only one side is infinite
    TreeBox point;
    for (int c = 0; c < 3; ++c) {
      point.lo[c] = std::min(float_below(p[c] - margin[c]), largest);
      point.hi[c] = std::max(float_above(p[c] + margin[c]), -largest);
    }
    add(point);
  }
  void add(const TreeBox& b) {
    lo = lo < b.lo ? lo : b.lo;
    hi = hi > b.hi ? hi : b.hi;
  }
  /// Grows by `margin` (m, >= 0) on every side, rounded outward: sum and difference are rounded once each.
  void inflate(double margin) {
    const float grow = float_above(margin);
    lo -= grow;
    hi += grow;
    lo -= rounding(lo);
    hi += rounding(hi);
  }
  bool overlaps(const TreeBox& b) const {
    const auto meet = (lo <= b.hi) & (b.lo <= hi);
    return (meet[0] & meet[1] & meet[2]) != 0;
  }

 private:
  static Four rounding(const Four& x) { return (x < 0 ? -x : x) * 0x1p-23f + 0x1p-126f; }
};

}  // namespace bb
