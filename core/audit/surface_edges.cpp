#include "core/audit/surface_edges.hpp"

#include <algorithm>
#include <map>

namespace bb::audit {
namespace {

struct Sharers {
  int triangles = 0;
  int third = -1;  // of the last of the triangles; -1: of none
  bool segment = false;
};

}  // namespace

void set_edges(const std::vector<TriangleVertices>& triangles, const std::vector<EdgeVertices>& segments,
               AuditMesh& mesh) {
  std::map<EdgeVertices, Sharers> edges;
  for (const TriangleVertices& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      Sharers& edge = edges[ascending(t[k], t[(k + 1) % 3])];
      ++edge.triangles, edge.third = t[(k + 2) % 3];
    }
  }
  for (const EdgeVertices& e : segments) edges[ascending(e[0], e[1])].segment = true;
  if (mesh.planar) {
    std::erase_if(edges, [](const auto& edge) { return edge.second.triangles > 1 && !edge.second.segment; });
  }
  mesh.edges.resize(2, static_cast<Eigen::Index>(edges.size()));
  mesh.opposite.clear();
  Eigen::Index i = 0;
  for (const auto& [edge, sharers] : edges) {
    mesh.edges.col(i++) << edge[0], edge[1];
    if (mesh.planar) mesh.opposite.push_back(sharers.third);
  }
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
