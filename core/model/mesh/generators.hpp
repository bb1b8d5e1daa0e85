// Procedural meshes. All are centred at the origin unless stated otherwise; closed surfaces are oriented
// outwards. Errors of all: ConfigError for a count or size out of range, and for a surface that does not fit
// into the memory of this process (core/base/input/memory.hpp).
#pragma once

#include "core/model/mesh/triangle_mesh.hpp"

namespace bb {

/// n_x x n_y vertices in the x-y plane, row by row (x fastest), corner at -size/2. Each quad with corners a b
/// (lower row) and c d (upper row) is split along the same diagonal into (a, b, d) and (a, d, c); normal +z.
/// Requires n_x, n_y >= 2 and sizes > 0 (ConfigError).
TriangleMesh grid_mesh(int n_x, int n_y, double size_x, double size_y);

/// Subdivided icosahedron with vertices on the sphere: 10 * 4^level + 2 vertices. 0 <= level <= 8.
TriangleMesh icosphere_mesh(int level, double radius);

/// Axis z, closed by caps when `closed`: n_around >= 3, n_along >= 1 rings of quads.
TriangleMesh cylinder_mesh(int n_around, int n_along, double radius, double length, bool closed);

/// A trunk about z from hips to neck, closed, of the height: a cylinder whose rings are ellipses, half as wide along y as
/// along x, widest at hips and chest: n_around >= 3, n_along >= 1.
TriangleMesh torso_mesh(int n_around, int n_along, double height);

/// Axis-aligned box with n >= 1 quads along each edge.
TriangleMesh box_mesh(int n, const Vec3d& size);

/// n_segments >= 1 equal segments from `from` to `to`; no triangles.
TriangleMesh rod_mesh(int n_segments, const Vec3d& from, const Vec3d& to);

/// Closed loop of n_segments >= 3 equal segments with its vertices on a circle in the x-y plane; no triangles.
TriangleMesh ring_mesh(int n_segments, double radius);

/// n_segments >= 1 equal segments with their vertices on a helix of axis z, right-handed, that rises by `pitch` (m) a turn; no
/// triangles.
TriangleMesh helix_mesh(int n_segments, double n_turns, double radius, double pitch);

}  // namespace bb
