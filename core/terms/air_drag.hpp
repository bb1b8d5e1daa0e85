// What drag of the air acts on.
#pragma once

#include <vector>

#include "core/scene/scene.hpp"

namespace bb {

/// Corners with mass of the triangles of the surface, ascending: the elements of the term.
std::vector<int> corners_in_air(const Scene& scene);
/// m/s, at the time t (s).
Vec3d wind_at(const Air& air, double t);

}  // namespace bb
