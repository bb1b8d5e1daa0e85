// The edges and vertices of a surface, made of its triangles and of what stands alone.
#pragma once

#include <array>
#include <vector>

#include "core/audit/surface.hpp"

namespace bb::audit {

using EdgeVertices = std::array<int, 2>;      // ascending
using TriangleVertices = std::array<int, 3>;  // counter-clockwise where the side matters

inline EdgeVertices ascending(int a, int b) { return a < b ? EdgeVertices{a, b} : EdgeVertices{b, a}; }

/// Fills edges and, of planar scenes, opposite vertices: every edge once, ascending. In space the edges of triangles
/// and the segments; in the plane the segments and edges of exactly one triangle. Cost: O(n), and a sort of the edges at each vertex.
void set_edges(const std::vector<TriangleVertices>& triangles, const std::vector<EdgeVertices>& segments,
               AuditMesh& mesh);

/// Fills the points: those of `vertices` that are on no edge of the mesh.
void set_points(const std::vector<int>& vertices, int n_vertices, AuditMesh& mesh);

/// All vertices of edges and (in 3D) triangles and the listed points, ascending.
std::vector<int> colliding_vertices(const AuditMesh& mesh);

/// [3 n]
Eigen::Matrix3Xi as_columns(const std::vector<TriangleVertices>& triangles);

}  // namespace bb::audit
