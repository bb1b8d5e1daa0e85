// Analytic obstacles: signed gap, normal and curvature at a point, and the first time a straight motion comes
// down to a level. Plane, sphere and cylinder, outside or inside.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "core/math/types.hpp"
#include "core/model/scene/scene.hpp"

namespace bb {

/// An obstacle as plain values.
template <class T>
struct AnalyticSurface {
  ObstacleKind kind;
  Vec<T, 3> point, axis;
  T radius;
  bool inside;
  int vertex = -1;  // of the scene, whose position is `point` (posed); -1: the obstacle stands still
};

template <class T>
AnalyticSurface<T> analytic_surface(const Obstacle& o) {
  return {o.kind, o.point.cast<T>(), o.axis.cast<T>(), static_cast<T>(o.radius), o.inside, o.vertex};
}

/// The obstacle where it is in the state x, m.
inline AnalyticSurface<double> posed(AnalyticSurface<double> s, const PositionsView& x) {
  if (s.vertex >= 0) s.point = x.col(s.vertex);
  return s;
}

/// All of them, into `out`.
inline void pose(const std::vector<AnalyticSurface<double>>& obstacles, const PositionsView& x,
                 std::vector<AnalyticSurface<double>>& out) {
  out.clear();
  for (const AnalyticSurface<double>& s : obstacles) out.push_back(posed(s, x));
}

/// The same obstacle in the scalar T.
template <class T>
BB_HD inline AnalyticSurface<T> surface_in(const AnalyticSurface<double>& s) {
  return {s.kind, s.point.cast<T>(), s.axis.cast<T>(), static_cast<T>(s.radius), s.inside, s.vertex};
}

/// Gap of a point, positive on the allowed side, and its derivatives:
///   grad d = normal,   grad^2 d = curvature (I - n n^T - flat flat^T).
template <class T>
struct SurfaceGap {
  T d;               // m, without any offset
  Vec<T, 3> normal;  // unit, towards the allowed side; zero where undefined (centre of a sphere, axis)
  T curvature;       // 1/m, negative inside
  Vec<T, 3> flat;    // direction without curvature: the axis of a cylinder, else zero
};

namespace detail {
/// Part of a vector that the gap depends on: all of it for a sphere, across the axis for a cylinder.
template <class T>
BB_HD inline Vec<T, 3> radial_part(const AnalyticSurface<T>& s, const Vec<T, 3>& v) {
  if (s.kind == ObstacleKind::sphere) return v;
  return v - s.axis.dot(v) * s.axis;
}
}  // namespace detail

/// Gap of the point x (m). Host-device, no allocation; exact up to rounding.
template <class T>
BB_HD inline SurfaceGap<T> surface_gap(const AnalyticSurface<T>& s, const Vec<T, 3>& x) {
  const Vec<T, 3> zero = Vec<T, 3>::Zero();
  const Vec<T, 3> q = x - s.point;
  if (s.kind == ObstacleKind::plane) return {s.axis.dot(q), s.axis, T(0), zero};
  const Vec<T, 3> r = detail::radial_part<T>(s, q);
  const T rho = r.norm(), sign = s.inside ? T(-1) : T(1);
  const Vec<T, 3> flat = s.kind == ObstacleKind::cylinder ? s.axis : zero;
  if (!(rho > 0)) return {sign * (rho - s.radius), zero, T(0), flat};
  return {sign * (rho - s.radius), r * (sign / rho), sign / rho, flat};
}

/// A time in [0, 1] before which the gap of x0 + t (x1 - x0) stays above `level` (m), 1 when it always does, over an
/// obstacle that goes straight from `s` to `end`, its pose at t = 1, and does not turn.
/// The first root, moved early by its own rounding; 0 when the gap at x0 is not above the level.
/// Host-device, no allocation.
template <class T>
BB_HD inline T first_time_at(const AnalyticSurface<T>& s, const AnalyticSurface<T>& end, const Vec<T, 3>& x0,
                             const Vec<T, 3>& x1, T level) {
  using std::abs;
  using std::sqrt;
  constexpr T eps = std::numeric_limits<T>::epsilon();
  const Vec<T, 3> moved = end.point - s.point;  // exactly 0 where nothing moves
  const Vec<T, 3> q0 = x0 - s.point, v = (x1 - x0) - moved;
  const T start = surface_gap<T>(s, x0).d - level;
  if (!(start > 0)) return T(0);
  const T early = 1 - 16 * eps;  // the formulas below are a dozen roundings
  if (s.kind == ObstacleKind::plane) {
    const T last = surface_gap<T>(end, x1).d - level;
    return last > 0 ? T(1) : early * (start / (start - last));
  }
  // |r0 + t u|^2 = bound^2 as a t^2 + 2 b t + c = 0, c by a difference of squares
  const Vec<T, 3> r0 = detail::radial_part<T>(s, q0), u = detail::radial_part<T>(s, v);
  const T bound = s.inside ? s.radius - level : s.radius + level;
  const T a = u.squaredNorm(), b = r0.dot(u);
  const T c = (s.inside ? -start : start) * (r0.norm() + bound);
  T t = 1;
  if (!s.inside) {
    if (!(b < 0)) return T(1);
    const T spread = b * b - a * c + 8 * eps * (b * b + a * abs(c));
    if (spread < 0) return T(1);
    t = c / (sqrt(spread) - b);
  } else {
    if (!(a > 0)) return T(1);
    const T root = sqrt((b * b - a * c) * (1 + 8 * eps));
    t = b > 0 ? -c / (b + root) : (root - b) / a;
  }
  t *= early;
  return t < 1 ? t : T(1);
}

}  // namespace bb
