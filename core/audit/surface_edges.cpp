#include "core/audit/surface_edges.hpp"

#include <algorithm>
#include <span>

namespace bb::audit {
namespace {

/// An edge of a triangle or of a segment, in the list of its lower vertex.
struct Side {
  static constexpr int of_segment = -1;
  int upper, third;  // third: vertex of the triangle, or of_segment
};

/// The sides of all triangles in their order, then the segments, by lower vertex: those of vertex v are
/// side[start[v], start[v + 1]).
struct SidesByVertex {
  std::vector<std::size_t> start;
  std::vector<Side> side;

  SidesByVertex(const std::vector<TriangleVertices>& triangles, const std::vector<EdgeVertices>& segments) {
    const auto for_each = [&](const auto& f) {
      for (const TriangleVertices& t : triangles) {
        for (std::size_t k = 0; k < 3; ++k) f(ascending(t[k], t[(k + 1) % 3]), t[(k + 2) % 3]);
      }
      for (const EdgeVertices& e : segments) f(ascending(e[0], e[1]), Side::of_segment);
    };
    int highest = -1;
    for_each([&](const EdgeVertices& edge, int) { highest = std::max(highest, edge[0]); });
    start.assign(static_cast<std::size_t>(highest + 2), 0);
    for_each([&](const EdgeVertices& edge, int) { ++start[static_cast<std::size_t>(edge[0]) + 1]; });
    for (std::size_t v = 1; v < start.size(); ++v) start[v] += start[v - 1];
    side.resize(start.back());
    std::vector<std::size_t> next(start.begin(), start.end() - 1);
    for_each([&](const EdgeVertices& edge, int third) {
      side[next[static_cast<std::size_t>(edge[0])]++] = {edge[1], third};
    });
  }
};

/// What shares an edge: the sides that are equal.
struct Sharers {
  int triangles = 0;
  int third = -1;  // of the last of the triangles; -1: of none
  bool segment = false;

  explicit Sharers(std::span<const Side> equal) {
    for (const Side& side : equal) {
      if (side.third == Side::of_segment) {
        segment = true;
      } else {
        ++triangles, third = side.third;
      }
    }
  }
};

}  // namespace

void set_edges(const std::vector<TriangleVertices>& triangles, const std::vector<EdgeVertices>& segments,
               AuditMesh& mesh) {
  SidesByVertex sides(triangles, segments);
  std::vector<EdgeVertices> edges;
  mesh.opposite.clear();
  for (std::size_t v = 0; v + 1 < sides.start.size(); ++v) {
    const std::span<Side> own(sides.side.data() + sides.start[v], sides.start[v + 1] - sides.start[v]);
    std::ranges::stable_sort(own, {}, &Side::upper);
    for (auto first = own.begin(); first != own.end();) {
      const auto last =
          std::find_if(first, own.end(), [&](const Side& s) { return s.upper != first->upper; });
      const Sharers sharers({first, last});
      const EdgeVertices edge{static_cast<int>(v), first->upper};
      first = last;
      if (mesh.planar && sharers.triangles > 1 && !sharers.segment) continue;
      edges.push_back(edge);
      if (mesh.planar) mesh.opposite.push_back(sharers.third);
    }
  }
  mesh.edges.resize(2, static_cast<Eigen::Index>(edges.size()));
  for (std::size_t i = 0; i < edges.size(); ++i)
    mesh.edges.col(static_cast<Eigen::Index>(i)) << edges[i][0], edges[i][1];
}

void set_points(const std::vector<int>& vertices, int n_vertices, AuditMesh& mesh) {
  std::vector<char> covered(static_cast<std::size_t>(n_vertices), 0);
  for (Eigen::Index i = 0; i < mesh.edges.cols(); ++i) {
    for (const int v : {mesh.edges(0, i), mesh.edges(1, i)}) covered[static_cast<std::size_t>(v)] = 1;
  }
  mesh.points.clear();
  for (const int v : vertices) {
    if (!covered[static_cast<std::size_t>(v)]) mesh.points.push_back(v);
  }
}

std::vector<int> colliding_vertices(const AuditMesh& mesh) {
  std::vector<int> out(mesh.points);
  out.insert(out.end(), mesh.edges.data(), mesh.edges.data() + mesh.edges.size());
  if (!mesh.planar)
    out.insert(out.end(), mesh.triangles.data(), mesh.triangles.data() + mesh.triangles.size());
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

Eigen::Matrix3Xi as_columns(const std::vector<TriangleVertices>& triangles) {
  Eigen::Matrix3Xi out(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t)
    out.col(static_cast<Eigen::Index>(t)) << triangles[t][0], triangles[t][1], triangles[t][2];
  return out;
}

}  // namespace bb::audit
