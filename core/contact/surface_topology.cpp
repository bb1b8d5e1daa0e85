#include "core/contact/surface_topology.hpp"

#include <algorithm>

namespace bb {
namespace {

using Members = std::vector<std::array<int, 2>>;

std::vector<int> points_of_vertices(const Surface& surface) {
  std::vector<int> point(surface.body.size(), -1);
  for (std::size_t i = 0; i < surface.points.size(); ++i)
    point[static_cast<std::size_t>(surface.points.vertices[i][0])] = static_cast<int>(i);
  return point;
}

/// Of each primitive the points of its vertices. Every vertex of an edge or a triangle is a point of the surface.
template <int N>
std::vector<std::array<int, N>> points_of(const std::vector<int>& point, const Primitives<N>& primitives) {
  std::vector<std::array<int, N>> out;
  for (const std::array<int, N>& vertices : primitives.vertices) {
    std::array<int, N> points;
    std::transform(vertices.begin(), vertices.end(), points.begin(),
                   [&](int v) { return point[static_cast<std::size_t>(v)]; });
    out.push_back(points);
  }
  return out;
}

std::vector<std::array<int, 3>> edges_of_triangles(const SurfaceTopology& of) {
  std::vector<std::array<int, 3>> out;
  for (const std::array<int, 3>& t : of.surface.triangles.vertices)
    out.push_back({of.edge_of(t[0], t[1]), of.edge_of(t[1], t[2]), of.edge_of(t[2], t[0])});
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

// The edges of a surface are sorted, each with its lower vertex first.
int SurfaceTopology::edge_of(int v, int w) const {
  const auto& edges = surface.edges.vertices;
  const std::array<int, 2> edge{std::min(v, w), std::max(v, w)};
  return static_cast<int>(std::lower_bound(edges.begin(), edges.end(), edge) - edges.begin());
}

SurfaceTopology::SurfaceTopology(const Surface& of)
    : surface(of),
      points(points_of_vertices(surface)),
      triangle_edges(edges_of_triangles(*this)),
      triangle_points(points_of<3>(points, surface.triangles)),
      edge_points(points_of<2>(points, surface.edges)),
      triangles_at_edge(surface.edges.size(), members_of(triangle_edges)),
      triangles_at_point(surface.points.size(), members_of(triangle_points)),
      edges_at_point(surface.points.size(), members_of(edge_points)) {}

}  // namespace bb
