// A surface as numbers: vertices, triangles and lone edges (segments that no triangle owns, such as rods).
// Readers are in read_mesh.hpp, procedural meshes in generators.hpp, derived sets in topology.hpp.
#pragma once

#include <array>
#include <vector>

#include "core/math/types.hpp"

namespace bb {

struct TriangleMesh {
  Positions vertices = Positions(3, 0);       // [3 x n] m
  std::vector<std::array<int, 3>> triangles;  // counter-clockwise seen from outside
  std::vector<std::array<int, 2>> segments;   // lone edges

  int n_vertices() const { return static_cast<int>(vertices.cols()); }
};

}  // namespace bb
