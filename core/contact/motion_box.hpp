// The box of a primitive at the start of a motion and that of its displacements, in float and rounded outward:
// one cache line, from which a time is proven up to which two primitives cannot meet.
#pragma once

#include <cstddef>
#include <limits>

#include "core/contact/float_rounding.hpp"
#include "core/math/lanes.hpp"
#include "core/math/types.hpp"

namespace bb {

/// Points of the primitive at time t are within lo + t slowest and hi + t fastest, its contact reach
/// included. The fourth lane holds nothing, in numbers that no quotient is slow with, as it is with subnormal ones.
struct alignas(64) MotionBox {
  using Four = VectorOf<float, 4>::type;
  Four lo, hi;            // m
  Four slowest, fastest;  // m per unit of time, per axis
};

namespace detail {

using FourDoubles = VectorOf<double, 4>::type;

/// float_below() and float_above(), four abreast.
inline MotionBox::Four floats_below(const FourDoubles& x) {
  const FourDoubles size = x < 0 ? -x : x;
  return __builtin_convertvector(x - room_of_rounding(size), MotionBox::Four);
}
inline MotionBox::Four floats_above(const FourDoubles& x) { return -floats_below(-x); }

inline FourDoubles point_of(const PositionsView& x, int vertex) {
  const double* p = x.data() + 3 * static_cast<std::ptrdiff_t>(vertex);
  return FourDoubles{p[0], p[1], p[2], 0.0};
}

}  // namespace detail

/// Box of the points that `corners` numbers, every one of them surrounded by `reach` (m).
template <class Corners>
MotionBox motion_box(const Corners& corners, double reach, const PositionsView& x0, const PositionsView& x1) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  detail::FourDoubles lo = inf - detail::FourDoubles{}, hi = -lo, slowest = lo, fastest = hi;
  for (const int v : corners) {
    const detail::FourDoubles x = detail::point_of(x0, v), dx = detail::point_of(x1, v) - x;
    lo = x < lo ? x : lo;
    hi = hi < x ? x : hi;
    slowest = dx < slowest ? dx : slowest;
    fastest = fastest < dx ? dx : fastest;
  }
  MotionBox box{detail::floats_below(lo - reach), detail::floats_above(hi + reach),
                detail::floats_below(slowest), detail::floats_above(fastest)};
  box.lo[3] = box.slowest[3] = 1;
  box.hi[3] = box.fastest[3] = 2;
  return box;
}

/// A time before which the contents of a and b are proven apart along some axis; 0 when nothing is proven.
inline float proven_time(const MotionBox& a, const MotionBox& b) {
  using Four = MotionBox::Four;
  constexpr float inf = std::numeric_limits<float>::infinity();
  const auto until = [](const Four& gap, const Four& rate) -> Four {
    const Four met = gap / -rate, never = inf - Four{}, zero = {};
    return gap > 0 ? (rate < 0 ? met : rate >= 0 ? never : zero) : zero;  // a rate may be NaN
  };
  const Four below = until(a.lo - b.hi, a.slowest - b.fastest);
  const Four above = until(b.lo - a.hi, b.slowest - a.fastest);
  const Four both = below > above ? below : above;
  const float xy = both[0] > both[1] ? both[0] : both[1];
  const float latest = xy > both[2] ? xy : both[2];
  // two differences and a quotient, each rounded once; a NaN is treated as bound 0
  return latest > 0 ? latest * (1 - 0x1p-20f) : 0;
}

}  // namespace bb
