// Floating filter first, rationals where it cannot decide. A point is beyond a quadric where its arm is shorter than
// the radius; arms are affine in the point, so the arms of an edge or a triangle are an edge or a triangle, and the
// question is how near it comes to the origin.
#include "core/audit/obstacle_sign.hpp"

#include <Eigen/Geometry>

#include <array>
#include <cmath>

#include "core/audit/closest_point.hpp"
#include "core/audit/quadric.hpp"

namespace bb::audit {
namespace {

/// Sign of v if the filter trusts it against terms of total size `size`, else 2.
int filtered(double v, double size) {
  if (!(size < 1e300)) return 2;
  return std::abs(v) > quadric_filter * size + quadric_underflow ? (v > 0.0 ? 1 : -1) : 2;
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
  const Rational3 arm = exact_arm(o, exact(x));
  return sgn(mpq_class(dot(arm, arm) - exact_radius_sq(o)));
}

int plane_side(const AuditObstacle& o, const Vec3d& x) {
  const Vec3d w = x - o.point;
  const int s = filtered(o.axis.dot(w), o.axis.cwiseAbs().dot(w.cwiseAbs()));
  return s != 2 ? s : sgn(dot(exact(o.axis), minus(exact(x), exact(o.point))));
}

/// True if one tangent plane has all points on its far side, in floating point with its allowance.
/// o: the obstacle of each point.
template <std::size_t N>
bool tangent_plane_separates(const std::array<const AuditObstacle*, N>& o, const std::array<Vec3d, N>& x) {
  std::array<Vec3d, N> w;
  const FloatArms first(*o[0]);
  double reach = first.radius;
  for (std::size_t k = 0; k < N; ++k) {
    const FloatArms arm(*o[k]);
    w[k] = arm(x[k]), reach += arm.reach(x[k]);
  }
  const Vec3d m = closest_to_origin(w);
  const double least = first.radius * m.norm() + quadric_filter * m.norm() * reach;
  if (!(least < 1e300 && least > quadric_underflow)) return false;
  for (const Vec3d& corner : w) {
    if (!(m.dot(corner) > least)) return false;
  }
  return true;
}

}  // namespace

int obstacle_side(const AuditObstacle& o, const Vec3d& x) {
  if (o.kind == ObstacleKind::plane) return plane_side(o, x);
  const int side = quadric_side(o, x);
  return o.inside ? -side : side;
}

bool obstacle_hit(const AuditObstacle& begin, const AuditObstacle& end, const Vec3d& x0, const Vec3d& x1) {
  if (begin.allows_a_convex_set()) return obstacle_side(begin, x0) < 0 || obstacle_side(end, x1) < 0;
  if (tangent_plane_separates(std::array{&begin, &end}, std::array{x0, x1})) return false;
  return simplex_comes_near(std::array{exact_arm(begin, exact(x0)), exact_arm(end, exact(x1))},
                            exact_radius_sq(begin));
}

bool obstacle_cuts(const AuditObstacle& o, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  if (o.allows_a_convex_set()) {
    return obstacle_side(o, a) < 0 || obstacle_side(o, b) < 0 || obstacle_side(o, c) < 0;
  }
  if (tangent_plane_separates(std::array{&o, &o, &o}, std::array{a, b, c})) return false;
  const std::array<Rational3, 3> arms{exact_arm(o, exact(a)), exact_arm(o, exact(b)), exact_arm(o, exact(c))};
  return simplex_comes_near(arms, exact_radius_sq(o));
}

}  // namespace bb::audit
