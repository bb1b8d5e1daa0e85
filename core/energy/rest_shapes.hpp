// Rest shapes of the triangles and tetrahedra of a scene.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/energy/tetrahedron.hpp"
#include "core/energy/triangle_membrane.hpp"
#include "core/math/types.hpp"

namespace bb {

/// Rest data of triangles at x_rest [3 x n_vertices] (m). `warp`: [n] warp directions, or empty for each
/// triangle's first edge. ConfigError when a triangle has no area (or the warp direction is normal to
/// it).
std::vector<TriangleRest<double>> triangle_rests(std::span<const std::array<int, 3>> triangles,
                                                 const PositionsView& x_rest, bool planar,
                                                 std::span<const Vec3d> warp = {});

/// Rest data of tetrahedra at x_rest [3 x n_vertices] (m). ConfigError: one whose volume is not positive.
std::vector<TetrahedronRest<double>> tetrahedron_rests(std::span<const std::array<int, 4>> tetrahedra,
                                                       const PositionsView& x_rest);

}  // namespace bb
