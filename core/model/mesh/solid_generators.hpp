// Procedural meshes of tetrahedra, without triangles: their surface is solid_faces (topology.hpp). All are centred at the origin, conforming,
// and every volume is positive. Errors of all: ConfigError for a count or size out of range, and for a mesh that does not fit into the
// memory of this process (core/base/input/memory.hpp).
#pragma once

#include "core/model/mesh/triangle_mesh.hpp"

namespace bb {

/// Axis-aligned box of n[0] x n[1] x n[2] cells, six tetrahedra each.
TriangleMesh solid_box_mesh(const std::array<int, 3>& n, const Vec3d& size);

/// Ball: the 20 n^3 tetrahedra between the centre and an icosahedron whose edges have n parts, pushed out to spheres.
TriangleMesh solid_ball_mesh(int n, double radius);

/// Cylinder with axis z; its disk has n_radial rings of which the k-th has 6 k edges, 18 n_radial^2 tetrahedra a layer.
TriangleMesh solid_cylinder_mesh(int n_radial, int n_along, double radius, double length);

/// Torus about z: a disk of radius `thin` as above, whose centre runs round a circle of radius `wide` > thin in n_around >= 3 layers.
TriangleMesh solid_torus_mesh(int n_radial, int n_around, double wide, double thin);

}  // namespace bb
