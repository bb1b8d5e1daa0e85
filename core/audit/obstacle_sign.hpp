// On which side of an analytic obstacle a vertex, an edge or a triangle is; exact. Planes, and obstacles with the surface
// inside, allow a convex set: there the vertices decide. Outside a sphere or a cylinder the point of an edge or a
// triangle that is closest to the centre or the axis decides, which may lie between free vertices.
#pragma once

#include "core/audit/surface.hpp"

namespace bb::audit {

/// Sign of the signed distance of x: +1 on the allowed side, 0 on the surface, -1 beyond it. Exact.
int obstacle_side(const AuditObstacle& obstacle, const Vec3d& x);

/// True if a point of the closed segment x0 x1 is strictly beyond the surface: an edge, or the straight path of a
/// vertex, past an obstacle that goes straight from `begin` to `end` meanwhile (an edge: both the same). Exact.
bool obstacle_hit(const AuditObstacle& begin, const AuditObstacle& end, const Vec3d& x0, const Vec3d& x1);

/// True if a point of the closed triangle a b c, which may have no area, is strictly beyond the surface. Exact for
/// finite input. Cost: about 50 ns where a plane separates the triangle from the obstacle, else tens of microseconds.
bool obstacle_cuts(const AuditObstacle& obstacle, const Vec3d& a, const Vec3d& b, const Vec3d& c);

}  // namespace bb::audit
