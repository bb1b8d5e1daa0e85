#include "core/model/mesh/topology.hpp"

#include <algorithm>
#include <iterator>
#include <string>
#include <tuple>

#include "core/math/products.hpp"

namespace bb {
namespace {

/// One side of a triangle: the edge it runs through and the corner opposite.
struct TriangleSide {
  int low, high;
  int triangle;
  int from, to, opposite;
  bool operator<(const TriangleSide& other) const {
    return std::tie(low, high, triangle) < std::tie(other.low, other.high, other.triangle);
  }
  bool same_edge(const TriangleSide& other) const { return low == other.low && high == other.high; }
};

std::vector<TriangleSide> sorted_sides(std::span<const std::array<int, 3>> triangles) {
  std::vector<TriangleSide> sides;
  sides.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int from = triangles[t][k], to = triangles[t][(k + 1) % 3];
      sides.push_back(
          {std::min(from, to), std::max(from, to), static_cast<int>(t), from, to, triangles[t][(k + 2) % 3]});
    }
  }
  std::sort(sides.begin(), sides.end());
  return sides;
}

using Edges = std::vector<std::array<int, 2>>;

void sort_once(Edges& edges) {
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
}

std::array<int, 2> edge_of(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

/// Sides of all faces, and pairs of corners that are no side of their own face.
struct FacePairs {
  Edges sides, across;
};

FacePairs face_pairs(const TriangleMesh& mesh) {
  FacePairs out;
  std::vector<char> in_fan(mesh.triangles.size(), 0);
  for (const auto& [first, n] : mesh.fans) {
    std::vector<int> corners(mesh.triangles[static_cast<std::size_t>(first)].begin(),
                             mesh.triangles[static_cast<std::size_t>(first)].end());
    for (int t = first; t < first + n; ++t) {
      in_fan[static_cast<std::size_t>(t)] = 1;
      if (t > first) corners.push_back(mesh.triangles[static_cast<std::size_t>(t)][2]);
    }
    const std::size_t m = corners.size();
    for (std::size_t i = 0; i < m; ++i) {
      for (std::size_t j = i + 1; j < m; ++j) {
        const bool side = j == i + 1 || (i == 0 && j + 1 == m);
        (side ? out.sides : out.across).push_back(edge_of(corners[i], corners[j]));
      }
    }
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    if (in_fan[t] == 0) out.sides.insert(out.sides.end(), {edge_of(a, b), edge_of(b, c), edge_of(c, a)});
  }
  sort_once(out.sides);
  sort_once(out.across);
  return out;
}

/// The pairs of neighbours of a vertex that are in none of its faces. beside: the two neighbours in each face. False where faces and
/// neighbours are not those of a grid.
bool add_lines(const Edges& beside, Edges& to) {
  std::vector<int> near;
  for (const auto& pair : beside) near.insert(near.end(), pair.begin(), pair.end());
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  Edges across;
  for (std::size_t i = 0; i < near.size(); ++i) {
    for (std::size_t j = i + 1; j < near.size(); ++j) {
      const std::array<int, 2> pair{near[i], near[j]};
      if (std::find(beside.begin(), beside.end(), pair) == beside.end()) across.push_back(pair);
    }
  }
  to.insert(to.end(), across.begin(), across.end());
  const std::size_t faces = beside.size(), neighbours = near.size(), lines = across.size();
  return faces == 0 || (faces == 1 && neighbours == 2) || (faces == 2 && neighbours == 3) ||
         (faces == 4 && neighbours == 4 && lines == 2);
}

}  // namespace

std::vector<std::array<int, 2>> face_diagonals(const TriangleMesh& mesh) {
  const FacePairs pairs = face_pairs(mesh);
  Edges out;
  std::set_difference(pairs.across.begin(), pairs.across.end(), pairs.sides.begin(), pairs.sides.end(),
                      std::back_inserter(out));
  return out;
}

std::vector<std::array<int, 2>> face_sides(const TriangleMesh& mesh) { return face_pairs(mesh).sides; }

GridLines skip_one_pairs(const TriangleMesh& mesh) {
  GridLines out;
  std::vector<char> in_quad(mesh.triangles.size(), 0);
  std::vector<Edges> beside(
      static_cast<std::size_t>(mesh.n_vertices()));  // of each vertex: its neighbours, face by face
  for (const auto& [first, n] : mesh.fans) {
    if (n != 2) continue;
    const auto& half = mesh.triangles[static_cast<std::size_t>(first)];
    const std::array<int, 4> corners{half[0], half[1], half[2],
                                     mesh.triangles[static_cast<std::size_t>(first) + 1][2]};
    in_quad[static_cast<std::size_t>(first)] = in_quad[static_cast<std::size_t>(first) + 1] = 1;
    for (std::size_t k = 0; k < 4; ++k) {
      beside[static_cast<std::size_t>(corners[k])].push_back(
          edge_of(corners[(k + 1) % 4], corners[(k + 3) % 4]));
    }
  }
  const auto lone = std::find(in_quad.begin(), in_quad.end(), 0);
  if (lone != in_quad.end()) {
    out.fault = "triangle " + std::to_string(lone - in_quad.begin()) + ", which is no half of a quad";
    return out;
  }
  for (std::size_t v = 0; v < beside.size(); ++v) {
    if (!add_lines(beside[v], out.pairs)) {
      out.fault = "vertex " + std::to_string(v) + ", at which no line of a grid goes on: it is in " +
                  std::to_string(beside[v].size()) + " quads";
      return out;
    }
  }
  sort_once(out.pairs);
  return out;
}

std::vector<std::array<int, 2>> unique_edges(const TriangleMesh& mesh) {
  std::vector<std::array<int, 2>> edges;
  edges.reserve(3 * mesh.triangles.size() + mesh.segments.size() + 6 * mesh.tetrahedra.size());
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
      edges.push_back({low, high});
    }
  }
  for (const auto& s : mesh.segments) edges.push_back({std::min(s[0], s[1]), std::max(s[0], s[1])});
  for (const auto& t : mesh.tetrahedra) {
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = i + 1; j < 4; ++j) edges.push_back({std::min(t[i], t[j]), std::max(t[i], t[j])});
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

std::vector<std::array<int, 2>> boundary_edges(std::span<const std::array<int, 3>> triangles) {
  const std::vector<TriangleSide> sides = sorted_sides(triangles);
  std::vector<std::array<int, 2>> edges;
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].same_edge(sides[i])) ++end;
    if (end == i + 1) edges.push_back({sides[i].from, sides[i].to});
    i = end;
  }
  return edges;
}

std::optional<std::array<int, 2>> open_side(std::span<const std::array<int, 3>> triangles) {
  std::vector<std::array<int, 2>> sides;
  for (const auto& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) sides.push_back({t[k], t[(k + 1) % 3]});
  }
  std::sort(sides.begin(), sides.end());
  const auto run = [&sides](const std::array<int, 2>& side) {
    const auto [from, to] = std::equal_range(sides.begin(), sides.end(), side);
    return to - from;
  };
  for (const auto& side : sides) {
    if (run(side) != 1 || run({side[1], side[0]}) != 1) return side;
  }
  return std::nullopt;
}

std::vector<std::array<int, 4>> edge_hinges(std::span<const std::array<int, 3>> triangles) {
  const std::vector<TriangleSide> sides = sorted_sides(triangles);
  std::vector<std::array<int, 4>> hinges;
  for (std::size_t i = 1; i < sides.size(); ++i) {
    const TriangleSide& a = sides[i - 1];
    if (sides[i].same_edge(a)) hinges.push_back({a.from, a.to, a.opposite, sides[i].opposite});
  }
  return hinges;
}

std::optional<CrowdedEdge> crowded_edge(std::span<const std::array<int, 3>> triangles) {
  const std::vector<TriangleSide> sides = sorted_sides(triangles);
  for (std::size_t i = 2; i < sides.size(); ++i) {
    const TriangleSide& side = sides[i];
    if (!sides[i - 2].same_edge(side)) continue;
    const auto shares = [&side](const TriangleSide& other) { return other.same_edge(side); };
    return CrowdedEdge{{side.low, side.high},
                       static_cast<int>(std::count_if(sides.begin(), sides.end(), shares))};
  }
  return std::nullopt;
}

SolidFaces solid_faces(std::span<const std::array<int, 4>> tetrahedra) {
  struct Face {
    std::array<int, 3> sorted, outward;
    int tetrahedron;
  };
  std::vector<Face> faces;
  faces.reserve(4 * tetrahedra.size());
  for (std::size_t t = 0; t < tetrahedra.size(); ++t) {
    const auto& [a, b, c, d] = tetrahedra[t];
    for (const std::array<int, 3>& outward : {std::array{a, c, b}, {a, b, d}, {a, d, c}, {b, c, d}}) {
      faces.push_back({outward, outward, static_cast<int>(t)});
      std::sort(faces.back().sorted.begin(), faces.back().sorted.end());
    }
  }
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    return std::tie(a.sorted, a.tetrahedron) < std::tie(b.sorted, b.tetrahedron);
  });
  SolidFaces out;
  for (std::size_t i = 0; i < faces.size();) {
    std::size_t end = i + 1;
    while (end < faces.size() && faces[end].sorted == faces[i].sorted) ++end;
    if (end == i + 1) out.surface.push_back(faces[i].outward);
    if (end > i + 2 && out.crowded < 0) out.crowded = faces[i].tetrahedron;
    i = end;
  }
  return out;
}

Vec3d area_vector(const Positions& x, const std::array<int, 3>& t) {
  const Vec3d u = x.col(t[1]) - x.col(t[0]), v = x.col(t[2]) - x.col(t[0]);
  return 0.5 * u.cross(v);
}

double tetrahedron_volume(const Positions& x, const std::array<int, 4>& t) {
  const Vec3d u = x.col(t[1]) - x.col(t[0]), v = x.col(t[2]) - x.col(t[0]), w = x.col(t[3]) - x.col(t[0]);
  return w.dot(accurate_cross<double>(u, v)) / 6;
}

double surface_area(const TriangleMesh& mesh) {
  double area = 0;
  for (const auto& t : mesh.triangles) area += area_vector(mesh.vertices, t).norm();
  return area;
}

}  // namespace bb
