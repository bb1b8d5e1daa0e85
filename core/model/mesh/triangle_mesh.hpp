// A mesh as numbers: vertices, triangles, lone edges (segments that no triangle owns, such as rods) and tetrahedra.
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
  std::vector<std::array<int, 2>>
      fans;  // of every face of more than three corners c0 c1 c2 ...: the first of its triangles
             // (c0 c1 c2), (c0 c2 c3), ..., and how many there are
  std::vector<std::array<int, 4>>
      tetrahedra;  // corner 3 on the side to which 0 1 2 runs counter-clockwise: volume > 0

  int n_vertices() const { return static_cast<int>(vertices.cols()); }
};

}  // namespace bb
