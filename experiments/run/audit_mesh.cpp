#include "experiments/run/audit_mesh.hpp"

#include <algorithm>
#include <map>

#include "core/mesh/topology.hpp"

namespace bb {
namespace {

using Edge = std::array<int, 2>;

audit::AuditObstacle to_audit(const Obstacle& obstacle) {
  audit::AuditObstacle out;
  out.kind = obstacle.kind == ObstacleKind::plane    ? audit::ObstacleKind::plane
             : obstacle.kind == ObstacleKind::sphere ? audit::ObstacleKind::sphere
                                                     : audit::ObstacleKind::cylinder;
  out.point = obstacle.point;
  out.axis = obstacle.axis;
  out.radius = obstacle.radius;
  out.inside = obstacle.inside;
  out.vertex = obstacle.vertex;
  return out;
}

template <std::size_t n>
Eigen::Matrix<int, static_cast<int>(n), Eigen::Dynamic> columns(const std::vector<std::array<int, n>>& list) {
  Eigen::Matrix<int, static_cast<int>(n), Eigen::Dynamic> out(n, static_cast<Eigen::Index>(list.size()));
  for (std::size_t i = 0; i < list.size(); ++i) {
    for (std::size_t k = 0; k < n; ++k)
      out(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) = list[i][k];
  }
  return out;
}

Edge ascending(int a, int b) { return a < b ? Edge{a, b} : Edge{b, a}; }

// Third vertex of the triangles that have the edge; of a boundary edge there is one.
std::map<Edge, int> third_vertices(const std::vector<std::array<int, 3>>& triangles) {
  std::map<Edge, int> out;
  for (const auto& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) out[ascending(t[k], t[(k + 1) % 3])] = t[(k + 2) % 3];
  }
  return out;
}

// From the triangles themselves, and rods from what the scene lists: each edge once, ascending.
std::vector<Edge> edges_of(const Scene& scene) {
  std::vector<Edge> out;
  if (scene.planar) {
    for (const auto& e : boundary_edges(scene.surface_triangles)) out.push_back(ascending(e[0], e[1]));
  } else {
    for (const auto& t : scene.surface_triangles) {
      for (std::size_t k = 0; k < 3; ++k) out.push_back(ascending(t[k], t[(k + 1) % 3]));
    }
  }
  for (const auto& e : scene.surface_edges) out.push_back(ascending(e[0], e[1]));
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

// Vertices of the surface and of no edge; in space every vertex of a triangle has one.
std::vector<int> points_of(const Scene& scene, const std::vector<Edge>& edges) {
  std::vector<char> covered(static_cast<std::size_t>(scene.n_vertices()), 0);
  for (const Edge& e : edges) {
    for (const int v : e) covered[static_cast<std::size_t>(v)] = 1;
  }
  std::vector<int> out;
  for (const int v : scene.surface_vertices) {
    if (!covered[static_cast<std::size_t>(v)]) out.push_back(v);
  }
  return out;
}

// Of each motion: the first that is the same, or -1 where a step turns it too far.
std::vector<int> rigid_bodies(const std::vector<RigidMotion>& motions, double dt) {
  constexpr double quarter_turn = 1.5707963267948966;
  std::vector<int> out;
  for (const RigidMotion& motion : motions) {
    const auto same = std::find_if(motions.begin(), motions.end(),
                                   [&motion](const RigidMotion& m) { return same_motion(m, motion); });
    const bool keeps_shape = !motion.changes_size() && motion.most_turning() * dt <= quarter_turn;
    out.push_back(keeps_shape || motion.is_static() ? static_cast<int>(same - motions.begin()) : -1);
  }
  return out;
}

}  // namespace

audit::AuditMesh make_audit_mesh(const Scene& scene, double dt) {
  audit::AuditMesh mesh;
  mesh.planar = scene.planar;
  const std::vector<Edge> edges = edges_of(scene);
  mesh.edges = columns(edges);
  mesh.points = points_of(scene, edges);
  if (scene.planar) {
    const std::map<Edge, int> third = third_vertices(scene.surface_triangles);
    for (const Edge& e : edges) {
      const auto found = third.find(e);
      mesh.opposite.push_back(found == third.end() ? -1 : found->second);
    }
  }
  mesh.fixed.assign(static_cast<std::size_t>(scene.n_vertices()), 0);
  mesh.prescribed = mesh.fixed;
  mesh.motion.assign(mesh.fixed.size(), -1);
  mesh.thickness = scene.offset;
  const std::vector<int> bodies = rigid_bodies(scene.motions, dt);
  for (const Pin& pin : scene.pins) {
    if (!pin.span.always()) continue;  // judged as what moves freely
    const auto v = static_cast<std::size_t>(pin.vertex);
    mesh.prescribed[v] = 1;
    mesh.motion[v] = bodies[static_cast<std::size_t>(pin.motion)];
    mesh.fixed[v] = scene.motions[static_cast<std::size_t>(pin.motion)].is_static();
  }
  auto triangles = scene.surface_triangles;
  if (scene.planar) {  // judged for inversion: what is prescribed cannot invert
    std::erase_if(triangles, [&mesh](const auto& t) { return mesh.all_prescribed(t); });
  }
  mesh.triangles = columns(triangles);
  for (const Obstacle& obstacle : scene.obstacles) mesh.obstacles.push_back(to_audit(obstacle));
  return mesh;
}

double audit_tolerance(const Scene& scene, double ccd_park) {
  return 0.1 * ccd_park * *std::min_element(scene.d_hat.begin(), scene.d_hat.end());
}

}  // namespace bb
