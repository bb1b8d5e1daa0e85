// Floating filter first, rationals where it cannot decide. A quadric's sign is |W|^2 - R^2 with W = x -
// centre for the sphere, W = (x - point) x axis for the cylinder: affine in x, so a motion gives a
// quadratic in time.
#include "core/audit/obstacle_sign.hpp"

#include <gmpxx.h>

#include <Eigen/Geometry>

#include <array>
#include <cmath>

namespace bb::audit {
namespace {

using Rational3 = std::array<mpq_class, 3>;

// Fewer than 30 relative roundings of 2^-53 enter any sum of terms below; underflow is covered
// as in predicates.cpp.
constexpr double filter = 0x1p-47;
constexpr double underflow = 0x1p-500;

Rational3 exact(const Vec3d& v) { return {mpq_class(v[0]), mpq_class(v[1]), mpq_class(v[2])}; }

mpq_class dot(const Rational3& a, const Rational3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Rational3 minus(const Rational3& a, const Rational3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

Rational3 cross(const Rational3& a, const Rational3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Rational3 exact_arm(const AuditObstacle& o, const Vec3d& x) {
  const Rational3 w = minus(exact(x), exact(o.point));
  return o.kind == ObstacleKind::cylinder ? cross(w, exact(o.axis)) : w;
}

mpq_class exact_radius_sq(const AuditObstacle& o) {
  const mpq_class r(o.radius);
  const Rational3 a = exact(o.axis);
  return o.kind == ObstacleKind::cylinder ? mpq_class(r * r * dot(a, a)) : mpq_class(r * r);
}

/// Sign of v if the filter trusts it against terms of total size `size`, else 2.
int filtered(double v, double size) {
  if (!(size < 1e300)) return 2;
  return std::abs(v) > filter * size + underflow ? (v > 0.0 ? 1 : -1) : 2;
}

/// +1 outside, -1 inside.
int quadric_side(const AuditObstacle& o, const Vec3d& x) {
  const Vec3d w = x - o.point;
  const bool cylinder = o.kind == ObstacleKind::cylinder;
  const double axis_sq = cylinder ? o.axis.squaredNorm() : 1.0;
  const double arm_sq = cylinder ? w.cross(o.axis).squaredNorm() : w.squaredNorm();
  const double radius_sq = o.radius * o.radius * axis_sq;
  const int s = filtered(arm_sq - radius_sq, w.squaredNorm() * axis_sq + radius_sq);
  if (s != 2) return s;
  const Rational3 arm = exact_arm(o, x);
  return sgn(mpq_class(dot(arm, arm) - exact_radius_sq(o)));
}

int plane_side(const AuditObstacle& o, const Vec3d& x) {
  const Vec3d w = x - o.point;
  const int s = filtered(o.axis.dot(w), o.axis.cwiseAbs().dot(w.cwiseAbs()));
  return s != 2 ? s : sgn(dot(exact(o.axis), minus(exact(x), exact(o.point))));
}

/// True if the whole chord is on the far side of one tangent plane, in floating point with its allowance.
bool tangent_plane_separates(const AuditObstacle& o, const Vec3d& x0, const Vec3d& x1) {
  const Vec3d w0 = x0 - o.point, w1 = x1 - o.point;
  Vec3d m = w0 + w1;
  if (o.kind == ObstacleKind::cylinder) m -= o.axis * (o.axis.dot(m) / o.axis.squaredNorm());
  const double reach = w0.norm() + w1.norm();
  const double size = reach * (reach + o.radius);
  const double least =
      o.radius * m.norm() + filter * size;  // m is orthogonal to the axis within 10 ulps of reach
  return size < 1e300 && size > underflow && m.dot(w0) > least && m.dot(w1) > least;
}

bool quadric_hit_outside(const AuditObstacle& o, const Vec3d& x0, const Vec3d& x1) {
  if (tangent_plane_separates(o, x0, x1)) return false;
  const Rational3 w0 = exact_arm(o, x0), w1 = exact_arm(o, x1), step = minus(w1, w0);
  const mpq_class a = dot(step, step), b = dot(w0, step), c = dot(w0, w0) - exact_radius_sq(o);
  const mpq_class end = a + 2 * b + c;
  if (sgn(c) < 0 || sgn(end) < 0) return true;
  const bool lowest_within = sgn(b) < 0 && b + a > 0;  // a t^2 + 2 b t + c is lowest at -b / a
  return lowest_within && b * b > a * c;
}

}  // namespace

int obstacle_side(const AuditObstacle& o, const Vec3d& x) {
  if (o.kind == ObstacleKind::plane) return plane_side(o, x);
  const int side = quadric_side(o, x);
  return o.inside ? -side : side;
}

bool obstacle_hit(const AuditObstacle& o, const Vec3d& x0, const Vec3d& x1) {
  const bool convex = o.kind == ObstacleKind::plane || o.inside;  // the allowed set: its chords stay in it
  if (convex) return obstacle_side(o, x0) < 0 || obstacle_side(o, x1) < 0;
  return quadric_hit_outside(o, x0, x1);
}

}  // namespace bb::audit
