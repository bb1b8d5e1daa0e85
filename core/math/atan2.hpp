// The angle of a vector in + - * / and fused multiply-adds by name, which both compilers leave as they are written: libraries differ in
// the last place.
#pragma once

#include <cmath>
#include <limits>

#include "core/math/host_device.hpp"

namespace bb::elementary {

/// A number that is known to twice the digits.
struct TwoParts {
  double hi, lo;
};
/// k right angles.
BB_HD inline TwoParts right_angles(int k) { return {k * 0x1.921fb54442d18p0, k * 0x1.1a62633145c07p-54}; }

/// A number and its arc tangent.
struct Centre {
  double c;
  TwoParts angle;
};
/// One close to n/d in [0, 1], 0 or a power of two with c d/2 <= n <= 2 c d.
BB_HD inline Centre centre_near(double n, double d) {
  if (n < 0.125 * d) return {0, {0, 0}};
  if (n < 0.37 * d) return {0.25, {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57}};
  if (n < 0.72 * d) return {0.5, {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56}};
  return {1, {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55}};
}

/// The angle of (x, y) for y > 0 within 1 ulp, of n the smaller, d the larger of |x| and |y|; n/d and d neither large nor small (atan2).
/// With a number c close to n/d, t = (n/d - c)/(1 + c n/d) and A = atan c:
///   atan(n/d) = A + atan t,   atan t = t - t^3/3 + t^5/5 - ...,   t^2 < 0.027: 10 terms leave 1e-17 of t
/// c is such that n - c d has no rounding. The angle is that more or less than a right or a straight angle.
BB_HD inline double angle_of(double n, double d, bool steep, bool backwards) {
  constexpr double part[] = {1. / 3, 1. / 5, 1. / 7, 1. / 9, 1. / 11, 1. / 13, 1. / 15, 1. / 17, 1. / 19};
  const Centre near = centre_near(n, d);
  const double top = n - near.c * d, add = near.c * n;
  const double bottom = d + add, bottom_lo = add - (bottom - d);
  const double inverse = 1 / bottom, t = top * inverse;
  const double t_lo = (std::fma(-t, bottom, top) - t * bottom_lo) * inverse;
  const double z = t * t, z_sq = z * z;
  double even = part[8], odd = part[7];
  for (int j = 6; j >= 2; j -= 2) {
    even = even * z_sq + part[j];
    odd = odd * z_sq + part[j - 1];
  }
  even = even * z_sq + part[0];
  const double cubic = t_lo - t * (z * (even - z * odd));

  const double sign = steep != backwards ? -1 : 1;
  const TwoParts turn = right_angles(steep ? 1 : backwards ? 2 : 0);
  const double a = sign * near.angle.hi, base = turn.hi + a;
  const double base_lo = (a - (base - turn.hi)) + (turn.lo + sign * near.angle.lo);
  const double sum = base + sign * t;
  return sum + ((sign * t - (sum - base)) + (base_lo + sign * cubic));
}

/// Where n/d is none, too small to matter beside a right angle, or at an end of what can be held.
BB_HD inline double angle_apart(double n, double d, bool steep, bool backwards) {
  if (!(n >= 0 && d >= 0)) return n + d;  // NaN
  if (n > std::numeric_limits<double>::max()) n = d = 1;
  const double scale = d > 1 ? 0x1p-200 : 0x1p300;
  if (n > 0 && n * scale >= d * scale * 0x1p-60) return angle_of(n * scale, d * scale, steep, backwards);
  if (steep || backwards) return right_angles(steep ? 1 : 2).hi;
  return n > 0 ? n / d : 0;
}

/// The angle of (x, y) in [-pi, pi], with the special values of std::atan2. Host-device: yes. Total.
BB_HD inline double atan2(double y, double x) {
  const double across = std::fabs(y), along = std::fabs(x);
  const bool steep = across > along, backwards = std::signbit(x);
  const double n = steep ? along : across, d = steep ? across : along;
  const bool ordinary = d >= 0x1p-800 && d <= 0x1p1000 && n >= d * 0x1p-60;
  return std::copysign(ordinary ? angle_of(n, d, steep, backwards) : angle_apart(n, d, steep, backwards), y);
}
BB_HD inline float atan2(float y, float x) {
  return static_cast<float>(atan2(static_cast<double>(y), static_cast<double>(x)));
}
inline long double atan2(long double y, long double x) { return std::atan2(y, x); }

}  // namespace bb::elementary
