#include "core/contact/surface_topology.hpp"

#include <algorithm>

namespace bb {
namespace {

using Members = std::vector<std::array<int, 2>>;

/// Of each primitive the points of its vertices. Every vertex of an edge or a triangle is a point of the surface.
template <int N>
std::vector<std::array<int, N>> points_of(const Surface& surface, const Primitives<N>& primitives) {
  std::vector<int> point(surface.body.size(), -1);
  for (std::size_t i = 0; i < surface.points.size(); ++i)
    point[static_cast<std::size_t>(surface.points.vertices[i][0])] = static_cast<int>(i);
  std::vector<std::array<int, N>> out;
  for (const std::array<int, N>& vertices : primitives.vertices) {
    std::array<int, N> points;
    std::transform(vertices.begin(), vertices.end(), points.begin(),
                   [&](int v) { return point[static_cast<std::size_t>(v)]; });
    out.push_back(points);
  }
  return out;
}

/// The edges of a surface are sorted, each with its lower vertex first.
std::vector<std::array<int, 3>> edges_of_triangles(const Surface& surface) {
  const auto& edges = surface.edges.vertices;
  std::vector<std::array<int, 3>> out;
  for (const std::array<int, 3>& t : surface.triangles.vertices) {
    std::array<int, 3> sides;
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      const std::array<int, 2> side{std::min(a, b), std::max(a, b)};
      sides[k] = static_cast<int>(std::lower_bound(edges.begin(), edges.end(), side) - edges.begin());
    }
    out.push_back(sides);
  }
  return out;
}

/// (member, primitive) of all primitives, in their order.
template <std::size_t N>
Members members_of(const std::vector<std::array<int, N>>& primitives) {
  Members out;
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    for (const int member : primitives[i]) out.push_back({member, static_cast<int>(i)});
  }
  return out;
}

}  // namespace

IndexLists::IndexLists(std::size_t n, const Members& members) : begin_(n + 1, 0), items_(members.size() + 1) {
  for (const auto& [thing, number] : members) ++begin_[static_cast<std::size_t>(thing) + 1];
  for (std::size_t i = 0; i < n; ++i) begin_[i + 1] += begin_[i];
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  for (const auto& [thing, number] : members) items_[next[static_cast<std::size_t>(thing)]++] = number;
}

SurfaceTopology::SurfaceTopology(const Surface& surface)
    : triangle_edges(edges_of_triangles(surface)),
      triangle_points(points_of<3>(surface, surface.triangles)),
      edge_points(points_of<2>(surface, surface.edges)),
      triangles_at_edge(surface.edges.size(), members_of(triangle_edges)),
      triangles_at_point(surface.points.size(), members_of(triangle_points)),
      edges_at_point(surface.points.size(), members_of(edge_points)) {}

}  // namespace bb
