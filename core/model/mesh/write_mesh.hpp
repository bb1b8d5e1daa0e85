// Meshes written by us: binary PLY, as frames are.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "core/model/mesh/triangle_mesh.hpp"

namespace bb {

/// One more scalar property of a PLY element, beside the coordinates or the corners: a value for each vertex
/// or each triangle. Our reader skips it.
struct PlyColumn {
  std::string name;
  std::variant<std::vector<int>, std::vector<double>> values;
};

/// The bytes of a binary little-endian PLY file, double coordinates; segments as `edge` elements,
/// tetrahedra as `tetrahedron` elements.
/// @param of_vertices columns of n_vertices values, after x y z
/// @param of_triangles columns of one value a triangle, after vertex_indices
std::string ply_bytes(const TriangleMesh& mesh, const std::vector<PlyColumn>& of_vertices = {},
                      const std::vector<PlyColumn>& of_triangles = {});

}  // namespace bb
