// On which side of an analytic obstacle a vertex is, at rest and along a straight motion; exact.
#pragma once

#include "core/audit/surface.hpp"

namespace bb::audit {

/// Sign of the signed distance of x: +1 on the allowed side, 0 on the surface, -1 beyond it. Exact.
int obstacle_side(const AuditObstacle& obstacle, const Vec3d& x);

/// True if x0 + t (x1 - x0) is strictly beyond the surface for some t in [0, 1]. Exact.
bool obstacle_hit(const AuditObstacle& obstacle, const Vec3d& x0, const Vec3d& x1);

}  // namespace bb::audit
