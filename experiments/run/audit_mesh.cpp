#include "experiments/run/audit_mesh.hpp"

namespace bb {
namespace {

audit::AuditObstacle to_audit(const Obstacle& obstacle) {
  audit::AuditObstacle out;
  out.kind = obstacle.kind == ObstacleKind::plane    ? audit::ObstacleKind::plane
             : obstacle.kind == ObstacleKind::sphere ? audit::ObstacleKind::sphere
                                                     : audit::ObstacleKind::cylinder;
  out.point = obstacle.point;
  out.axis = obstacle.axis;
  out.radius = obstacle.radius;
  out.inside = obstacle.inside;
  return out;
}

}  // namespace

audit::AuditMesh make_audit_mesh(const Scene& scene) {
  audit::AuditMesh mesh;
  mesh.planar = scene.planar;
  const auto& triangles = scene.planar ? scene.membrane.triangles : scene.surface_triangles;
  mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    mesh.triangles.col(static_cast<Eigen::Index>(i)) << triangles[i][0], triangles[i][1], triangles[i][2];
  }
  mesh.edges.resize(2, static_cast<Eigen::Index>(scene.surface_edges.size()));
  for (std::size_t i = 0; i < scene.surface_edges.size(); ++i) {
    mesh.edges.col(static_cast<Eigen::Index>(i)) << scene.surface_edges[i][0], scene.surface_edges[i][1];
  }
  std::vector<std::uint8_t> covered(static_cast<std::size_t>(scene.n_vertices()), 0);
  for (const auto& triangle : triangles) {
    for (const int v : triangle) covered[static_cast<std::size_t>(v)] = 1;
  }
  for (const auto& edge : scene.surface_edges) {
    for (const int v : edge) covered[static_cast<std::size_t>(v)] = 1;
  }
  for (const int v : scene.surface_vertices) {
    if (!covered[static_cast<std::size_t>(v)]) mesh.points.push_back(v);
  }
  mesh.fixed.assign(static_cast<std::size_t>(scene.n_vertices()), 0);
  for (const Pin& pin : scene.pins) {
    const bool still = scene.motions[static_cast<std::size_t>(pin.motion)].is_static();
    mesh.fixed[static_cast<std::size_t>(pin.vertex)] = still;
  }
  for (const Obstacle& obstacle : scene.obstacles) mesh.obstacles.push_back(to_audit(obstacle));
  return mesh;
}

}  // namespace bb
