// Sets derived from a mesh: unique edges, boundary, interior edges with their opposite vertices, components, surface of solids.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/model/mesh/triangle_mesh.hpp"

namespace bb {

/// Every edge of a triangle or a tetrahedron and every segment once, as (smaller, larger) index, sorted. Cost O(n log n).
std::vector<std::array<int, 2>> unique_edges(const TriangleMesh& mesh);

/// Pairs of vertices of a face that are no side of it, of all faces of more than three corners (TriangleMesh::fans), and no
/// side of another face; as (smaller, larger) index, sorted, each once. Cost: n (n - 3)/2 of a face of n corners.
std::vector<std::array<int, 2>> face_diagonals(const TriangleMesh& mesh);

/// Sides of all faces of triangles and of fans, the same way.
std::vector<std::array<int, 2>> face_sides(const TriangleMesh& mesh);

/// Vertices two apart along the lines of a surface of quads: two neighbours of a vertex that no face has with it, the same way.
struct GridLines {
  std::vector<std::array<int, 2>> pairs;
  std::string
      fault;  // why the mesh has no such lines, "triangle 3, which is no half of a quad"; empty: it has
};
/// Lines go on at a vertex of four quads, or of two at the border; they end where it has one. Every other vertex is a fault.
GridLines skip_one_pairs(const TriangleMesh& mesh);

/// Edges of exactly one triangle, in the direction that the triangle runs through them, sorted
/// by (smaller, larger).
std::vector<std::array<int, 2>> boundary_edges(std::span<const std::array<int, 3>> triangles);

/// An edge that triangles do not run through exactly once in each direction, in the direction of one of them; none: the
/// surface is closed, or there is no triangle. Cost O(n log n).
std::optional<std::array<int, 2>> open_side(std::span<const std::array<int, 3>> triangles);

/// e0 e1 v0 v1 of every edge with exactly two triangles: triangle 0 runs e0 -> e1 and has v0 opposite,
/// triangle 1 has v1 opposite. Sorted by edge. Of a surface without a crowded edge.
std::vector<std::array<int, 4>> edge_hinges(std::span<const std::array<int, 3>> triangles);

/// An edge of three triangles or more: a surface has no angle there. The first in the order (smaller, larger). Cost O(n log n).
struct CrowdedEdge {
  std::array<int, 2> edge;
  int n_triangles;
};
std::optional<CrowdedEdge> crowded_edge(std::span<const std::array<int, 3>> triangles);

/// Faces of tetrahedra of positive volume.
struct SolidFaces {
  std::vector<std::array<int, 3>>
      surface;       // of one tetrahedron only, seen counter-clockwise from outside; sorted by vertices
  int crowded = -1;  // a tetrahedron with a face that two others have too; -1: none
};
SolidFaces solid_faces(std::span<const std::array<int, 4>> tetrahedra);

/// Sum of triangle areas, m^2.
double surface_area(const TriangleMesh& mesh);
/// (x1 - x0) x (x2 - x0) / 2, m^2.
Vec3d area_vector(const Positions& x, const std::array<int, 3>& triangle);
/// Signed volume, m^3.
double tetrahedron_volume(const Positions& x, const std::array<int, 4>& tetrahedron);

}  // namespace bb
