// Closest points of simplices to the origin and to each other in floating point. The audit's own: hints for directions
// that separate, and the numbers of surface_gap; no verdict rests on them.
#pragma once

#include <array>

#include "core/math/types.hpp"

namespace bb::audit {

/// Of the closed segment a b to the origin, m.
Vec3d closest_to_origin(const Vec3d& a, const Vec3d& b);
/// Of the closed triangle a b c to the origin, m; it may have no area.
Vec3d closest_to_origin(const Vec3d& a, const Vec3d& b, const Vec3d& c);
inline Vec3d closest_to_origin(const std::array<Vec3d, 2>& s) { return closest_to_origin(s[0], s[1]); }
inline Vec3d closest_to_origin(const std::array<Vec3d, 3>& t) { return closest_to_origin(t[0], t[1], t[2]); }

/// Distance of the closed segments p q and a b, m; they may have no length.
double segment_distance(const Vec3d& p, const Vec3d& q, const Vec3d& a, const Vec3d& b);

}  // namespace bb::audit
