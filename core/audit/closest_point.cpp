#include "core/audit/closest_point.hpp"

#include <algorithm>

namespace bb::audit {

Vec3d closest_to_origin(const Vec3d& a, const Vec3d& b) {
  const Vec3d side = b - a;
  const double length_sq = side.squaredNorm();
  if (!(length_sq > 0.0)) return a;
  return a + side * std::clamp(-a.dot(side) / length_sq, 0.0, 1.0);
}

Vec3d closest_to_origin(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d normal = (b - a).cross(c - a);
  const double area_sq = normal.squaredNorm();
  if (area_sq > 0.0 && normal.dot(a.cross(b)) >= 0.0 && normal.dot(b.cross(c)) >= 0.0 &&
      normal.dot(c.cross(a)) >= 0.0) {
    return normal * (normal.dot(a) / area_sq);  // the foot on the plane is inside
  }
  Vec3d best = closest_to_origin(a, b);
  for (const Vec3d& other : {closest_to_origin(b, c), closest_to_origin(c, a)}) {
    if (other.squaredNorm() < best.squaredNorm()) best = other;
  }
  return best;
}

// The two lines first; outside of the segments an end of one of them decides.
double segment_distance(const Vec3d& p, const Vec3d& q, const Vec3d& a, const Vec3d& b) {
  double least = closest_to_origin(p - a, q - a).norm();
  least = std::min(least, closest_to_origin(p - b, q - b).norm());
  least = std::min(least, closest_to_origin(a - p, b - p).norm());
  least = std::min(least, closest_to_origin(a - q, b - q).norm());
  const Vec3d u = q - p, v = b - a, w = p - a;
  const double uu = u.squaredNorm(), uv = u.dot(v), vv = v.squaredNorm(), uw = u.dot(w), vw = v.dot(w);
  const double det = uu * vv - uv * uv;
  if (!(det > 1e-12 * uu * vv)) return least;  // nearly parallel: ends are as close, but for rounding
  const double s = (uv * vw - vv * uw) / det, t = (uu * vw - uv * uw) / det;
  if (s <= 0.0 || s >= 1.0 || t <= 0.0 || t >= 1.0) return least;
  return std::min(least, (w + s * u - t * v).norm());
}

}  // namespace bb::audit
