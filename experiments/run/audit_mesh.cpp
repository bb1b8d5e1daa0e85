#include "experiments/run/audit_mesh.hpp"

#include <algorithm>

#include "core/audit/surface_edges.hpp"

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
  out.vertex = obstacle.vertex;
  return out;
}

// Of each motion: the first that is the same, or -1 where a step turns it too far.
std::vector<int> rigid_bodies(const std::vector<PrescribedMotion>& motions, double dt) {
  constexpr double quarter_turn = 1.5707963267948966;
  std::vector<int> out;
  for (const PrescribedMotion& motion : motions) {
    const auto same = std::find_if(motions.begin(), motions.end(),
                                   [&motion](const PrescribedMotion& m) { return same_motion(m, motion); });
    const bool keeps_shape = !motion.changes_size() && motion.most_turning() * dt <= quarter_turn;
    out.push_back(keeps_shape || motion.is_static() ? static_cast<int>(same - motions.begin()) : -1);
  }
  return out;
}

/// Pairs that a step is proven for when it is over.
audit::JudgedPairs judged_pairs(const Scene& scene) {
  audit::JudgedPairs out;
  for (const CollisionPair& pair : scene.collisions.pairs) {
    if (pair.kind == CollisionKind::audited) out.late.push_back({pair.first, pair.second});
  }
  if (out.late.empty()) return out;
  out.owner = scene.body;
  out.n_bodies = static_cast<int>(scene.bodies.size());
  return out;
}

}  // namespace

audit::AuditMesh make_audit_mesh(const Scene& scene, double dt, bool only_points) {
  audit::AuditMesh mesh;
  mesh.only_points = only_points;
  mesh.planar = scene.planar;
  audit::set_edges(scene.surface_triangles, scene.surface_edges, mesh);
  audit::set_points(scene.surface_vertices, scene.n_vertices(), mesh);
  mesh.fixed.assign(static_cast<std::size_t>(scene.n_vertices()), 0);
  mesh.prescribed = mesh.fixed;
  mesh.motion.assign(mesh.fixed.size(), -1);
  mesh.thickness = scene.offset;
  mesh.judged = judged_pairs(scene);
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
  mesh.triangles = audit::as_columns(triangles);
  for (const Obstacle& obstacle : scene.obstacles) mesh.obstacles.push_back(to_audit(obstacle));
  return mesh;
}

double audit_tolerance(const Scene& scene, double min_gap_fraction) {
  return 0.1 * min_gap_fraction * *std::min_element(scene.d_hat.begin(), scene.d_hat.end());
}

audit::AuditMesh audit_mesh_of(const RunConfig& config, const Scene& scene) {
  return make_audit_mesh(scene, config.time.dt, config.contact.model == ContactModel::points);
}

}  // namespace bb
