// The decision tree of signs: general position, coplanar (projected), degenerate (segments in 3D).
#include "core/audit/segment_triangle.hpp"

#include <algorithm>

#include "core/audit/predicates.hpp"

namespace bb::audit {
namespace {

/// The two coordinates other than `axis`, in cyclic order.
Vec2d drop(const Vec3d& p, int axis) { return {p[(axis + 1) % 3], p[(axis + 2) % 3]}; }

template <class V>
bool boxes_meet(const V& p, const V& q, const V& a, const V& b) {
  for (int k = 0; k < V::RowsAtCompileTime; ++k) {
    if (std::max(p[k], q[k]) < std::min(a[k], b[k]) || std::max(a[k], b[k]) < std::min(p[k], q[k]))
      return false;
  }
  return true;
}

/// Closed triangle with non-zero area contains x.
bool inside_2d(const Vec2d& x, const Vec2d& a, const Vec2d& b, const Vec2d& c) {
  const int s0 = orient2d(a, b, x), s1 = orient2d(b, c, x), s2 = orient2d(c, a, x);
  return (s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0);
}

bool meet_2d(const Vec2d& p, const Vec2d& q, const Vec2d& a, const Vec2d& b) {
  return segment_segment_2d(p, q, a, b) != Crossing::none;
}

/// Closed segments p q and a b in space.
bool meet_3d(const Vec3d& p, const Vec3d& q, const Vec3d& a, const Vec3d& b) {
  if (!boxes_meet(p, q, a, b) || orient3d(p, q, a, b) != 0) return false;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec2d p2 = drop(p, axis), q2 = drop(q, axis), a2 = drop(a, axis), b2 = drop(b, axis);
    const bool spans_plane = orient2d(p2, q2, a2) != 0 || orient2d(p2, q2, b2) != 0 ||
                             orient2d(a2, b2, p2) != 0 || orient2d(a2, b2, q2) != 0;
    if (spans_plane) return meet_2d(p2, q2, a2, b2);  // the projection is one-to-one on their plane
  }
  return true;  // all four on one line: there, segments meet iff their boxes do
}

/// Coplanar and closed, or a triangle without area.
bool meet_flat(const Vec3d& p, const Vec3d& q, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  for (int axis = 0; axis < 3; ++axis) {
    const Vec2d a2 = drop(a, axis), b2 = drop(b, axis), c2 = drop(c, axis);
    if (orient2d(a2, b2, c2) == 0) continue;
    const Vec2d p2 = drop(p, axis), q2 = drop(q, axis);
    return inside_2d(p2, a2, b2, c2) || inside_2d(q2, a2, b2, c2) || meet_2d(p2, q2, a2, b2) ||
           meet_2d(p2, q2, b2, c2) || meet_2d(p2, q2, c2, a2);
  }
  return meet_3d(p, q, a, b) || meet_3d(p, q, b, c) || meet_3d(p, q, c, a);
}

}  // namespace

Crossing segment_segment_2d(const Vec2d& p, const Vec2d& q, const Vec2d& a, const Vec2d& b) {
  if (!boxes_meet(p, q, a, b)) return Crossing::none;
  const int sa = orient2d(p, q, a), sb = orient2d(p, q, b);
  if (sa * sb > 0) return Crossing::none;
  const int sp = orient2d(a, b, p), sq = orient2d(a, b, q);
  if (sp * sq > 0) return Crossing::none;
  // With a zero sign the closed segments meet: on one line their boxes do; elsewhere the lines meet in one
  // point, which either pair of signs puts into its segment. A degenerate segment has both signs of its
  // own line zero.
  return sa * sb < 0 && sp * sq < 0 ? Crossing::crossing : Crossing::touch;
}

Crossing segment_triangle(const Vec3d& p, const Vec3d& q, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const int side_p = orient3d(a, b, c, p), side_q = orient3d(a, b, c, q);
  if (side_p * side_q > 0) return Crossing::none;
  if (side_p == 0 && side_q == 0) return meet_flat(p, q, a, b, c) ? Crossing::touch : Crossing::none;
  // The line p q meets the plane in one point; these are the signs of its barycentric coordinates.
  const int s0 = orient3d(p, q, a, b), s1 = orient3d(p, q, b, c), s2 = orient3d(p, q, c, a);
  const int lowest = std::min({s0, s1, s2}), highest = std::max({s0, s1, s2});
  if (lowest < 0 && highest > 0) return Crossing::none;
  const bool strictly_inside = lowest > 0 || highest < 0;
  return strictly_inside && side_p * side_q < 0 ? Crossing::crossing : Crossing::touch;
}

}  // namespace bb::audit
