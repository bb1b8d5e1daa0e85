// Whether surfaces intersect in a state: what is required of pairs of bodies that collide as `static` (CollisionKind::static_test).
#pragma once

#include <vector>

#include "core/contact/bvh.hpp"
#include "core/contact/surface.hpp"

namespace bb {

/// Whether a segment p q has a point in the triangle a b c, its border included. In floating point: what only touches may be
/// answered either way, and a segment in the plane of the triangle is answered with no, since its distance to the sides shows that
/// it is there.
bool pierces(const Vec3d& p, const Vec3d& q, const Vec3d& a, const Vec3d& b, const Vec3d& c);

/// Whether one of the pairs (edge, triangle) does at x [3 x n] m. Parallel. Cost O(pairs).
bool any_intersection(const Surface& surface, const std::vector<IndexPair>& edge_triangle,
                      const PositionsView& x);

}  // namespace bb
