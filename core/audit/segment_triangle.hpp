// Whether a segment meets a triangle (3D) or another segment (2D), by exact signs alone: no
// division, no tolerance.
#pragma once

#include "core/math/types.hpp"

namespace bb::audit {

/// crossing: the relative interiors meet in one point transversally; touch: the closed sets meet in
/// any other way.
enum class Crossing { none, touch, crossing };

/// Closed segment p q against closed triangle a b c. `crossing` iff p and q lie strictly on opposite sides of
/// the plane and the segment passes strictly inside the triangle; coplanar and degenerate input that meets is
/// `touch`. Exact for all finite input. Cost: at most 5 orient3d in general position.
Crossing segment_triangle(const Vec3d& p, const Vec3d& q, const Vec3d& a, const Vec3d& b, const Vec3d& c);

/// Closed segments p q and a b in the plane. `crossing` iff each separates the other's end points strictly.
Crossing segment_segment_2d(const Vec2d& p, const Vec2d& q, const Vec2d& a, const Vec2d& b);

}  // namespace bb::audit
