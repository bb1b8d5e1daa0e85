// Spheres and cylinders as one thing: the arm of a point, an affine function of it, is longer than a radius where the
// point is outside. Exact parts in rationals, and the floating filter that spares them.
#pragma once

#include <gmpxx.h>

#include <array>

#include "core/audit/surface.hpp"

namespace bb::audit {

using Rational3 = std::array<mpq_class, 3>;

// Fewer than 30 relative roundings of 2^-53 enter any sum of terms that the filter is applied to; underflow is
// covered as in predicates.cpp.
inline constexpr double quadric_filter = 0x1p-47;
inline constexpr double quadric_underflow = 0x1p-500;

inline Rational3 exact(const Vec3d& v) { return {mpq_class(v[0]), mpq_class(v[1]), mpq_class(v[2])}; }

inline mpq_class dot(const Rational3& a, const Rational3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

inline Rational3 minus(const Rational3& a, const Rational3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

inline Rational3 cross(const Rational3& a, const Rational3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// x - centre for a sphere; (x - point) x axis for a cylinder, as long as the distance to the axis times |axis|.
inline Rational3 exact_arm(const AuditObstacle& o, const Rational3& x) {
  const Rational3 w = minus(x, exact(o.point));
  return o.kind == ObstacleKind::cylinder ? cross(w, exact(o.axis)) : w;
}

/// What the squared length of an arm is compared with.
inline mpq_class exact_radius_sq(const AuditObstacle& o) {
  const mpq_class r(o.radius);
  const Rational3 a = exact(o.axis);
  return o.kind == ObstacleKind::cylinder ? mpq_class(r * r * dot(a, a)) : mpq_class(r * r);
}

/// True if a point of the closed simplex of these arms is nearer to the origin than the radius, strictly. Exact.
bool simplex_comes_near(const std::array<Rational3, 2>& arms, const mpq_class& radius_sq);
bool simplex_comes_near(const std::array<Rational3, 3>& arms, const mpq_class& radius_sq);

/// Arms in floating point: each entry is wrong by at most 2^-50 `reach`, where radius and arms are numbers of the same
/// unit.
struct FloatArms {
  explicit FloatArms(const AuditObstacle& obstacle)
      : o(obstacle),
        cylinder(o.kind == ObstacleKind::cylinder),
        stretch(cylinder ? o.axis.norm() : 1.0),
        radius(o.radius * stretch) {}

  Vec3d operator()(const Vec3d& x) const {
    const Vec3d w = x - o.point;
    return cylinder ? Vec3d(w.cross(o.axis)) : w;
  }
  /// Of a point: what its arm's rounding is relative to.
  double reach(const Vec3d& x) const { return (x - o.point).norm() * stretch; }

  const AuditObstacle& o;
  bool cylinder;
  double stretch, radius;
};

}  // namespace bb::audit
