// The box of a primitive at the start of a motion and that of its displacements, in float and rounded outward:
// one cache line, from which a time is proven up to which two primitives cannot meet.
#pragma once

#include <limits>

#include "core/contact/float_rounding.hpp"
#include "core/math/lanes.hpp"
#include "core/math/types.hpp"

namespace bb {

/// Points of the primitive at time t are within lo + t slowest and hi + t fastest, its contact reach
/// included. The fourth lane holds nothing: lo above hi.
struct alignas(64) MotionBox {
  using Four = VectorOf<float, 4>::type;
  Four lo, hi;            // m
  Four slowest, fastest;  // m per unit of time, per axis
};

/// Box of the points that `corners` numbers, every one of them surrounded by `reach` (m).
template <class Corners>
MotionBox motion_box(const Corners& corners, double reach, const PositionsView& x0, const PositionsView& x1) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  Vec3d lo = Vec3d::Constant(inf), hi = -lo, slowest = lo, fastest = hi;
  for (const int v : corners) {
    const Vec3d x = x0.col(v), dx = x1.col(v) - x;
    lo = lo.cwiseMin(x);
    hi = hi.cwiseMax(x);
    slowest = slowest.cwiseMin(dx);
    fastest = fastest.cwiseMax(dx);
  }
  MotionBox box{};
  for (int c = 0; c < 3; ++c) {
    box.lo[c] = float_below(lo[c] - reach);
    box.hi[c] = float_above(hi[c] + reach);
    box.slowest[c] = float_below(slowest[c]);
    box.fastest[c] = float_above(fastest[c]);
  }
  box.lo[3] = 1;
  box.hi[3] = 2;
  return box;
}

/// A time before which the contents of a and b are proven apart along some axis; 0 when nothing is proven.
inline float proven_time(const MotionBox& a, const MotionBox& b) {
  using Four = MotionBox::Four;
  constexpr float inf = std::numeric_limits<float>::infinity();
  const auto until = [](const Four& gap, const Four& rate) -> Four {
    const Four met = gap / -rate, never = inf - Four{}, zero = {};
    return gap > 0 ? (rate < 0 ? met : rate >= 0 ? never : zero) : zero;  // a rate may be no number
  };
  const Four below = until(a.lo - b.hi, a.slowest - b.fastest);
  const Four above = until(b.lo - a.hi, b.slowest - a.fastest);
  const Four both = below > above ? below : above;
  const float xy = both[0] > both[1] ? both[0] : both[1];
  const float latest = xy > both[2] ? xy : both[2];
  // two differences and a quotient, each rounded once; what is no number proves nothing
  return latest > 0 ? latest * (1 - 0x1p-20f) : 0;
}

}  // namespace bb
