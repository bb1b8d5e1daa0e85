#include "experiments/run/prescribed_crossings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "core/audit/audit.hpp"
#include "experiments/run/audit_mesh.hpp"
#include "experiments/run/audit_verdict.hpp"

namespace bb {
namespace {

/// The primitives without a free vertex.
audit::AuditMesh prescribed_part(const audit::AuditMesh& mesh) {
  audit::AuditMesh out = mesh;
  Eigen::Index n_edges = 0, n_triangles = 0;
  out.opposite.clear();
  for (Eigen::Index e = 0; e < mesh.edges.cols(); ++e) {
    if (!mesh.all_prescribed(mesh.edges.col(e))) continue;
    out.edges.col(n_edges++) = mesh.edges.col(e);
    if (!mesh.opposite.empty()) out.opposite.push_back(mesh.opposite[static_cast<std::size_t>(e)]);
  }
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    if (mesh.all_prescribed(mesh.triangles.col(t))) out.triangles.col(n_triangles++) = mesh.triangles.col(t);
  }
  out.edges.conservativeResize(2, n_edges);
  out.triangles.conservativeResize(3, n_triangles);
  out.points.clear();
  for (int v = 0; v < static_cast<int>(mesh.prescribed.size()); ++v) {
    const bool of_obstacle = std::any_of(mesh.obstacles.begin(), mesh.obstacles.end(),
                                         [v](const audit::AuditObstacle& o) { return o.vertex == v; });
    if (mesh.is_prescribed(v) && !of_obstacle) out.points.push_back(v);
  }
  return out;
}

/// Prescribed vertices that move relative to each other, or to an obstacle, may cross.
bool may_cross(const Scene& scene) {
  std::set<int> motions;
  bool driven = false, films = false;
  for (const Pin& pin : scene.pins) {
    const PrescribedMotion& motion = scene.motions[static_cast<std::size_t>(pin.motion)];
    motions.insert(pin.motion);
    driven = driven || !motion.is_static();
    films = films || motion.film != nullptr;
  }
  return films || (driven && (motions.size() > 1 || !scene.obstacles.empty()));
}

}  // namespace

int steps_of_motions(const Scene& scene, double dt) {
  double last = 0;
  for (const PrescribedMotion& motion : scene.motions) {
    if (std::isfinite(motion.last_change())) last = std::max(last, motion.last_change());
  }
  return static_cast<int>(std::min(std::ceil(last / dt), 1e9));
}

std::vector<PrescribedCrossing> prescribed_crossings(const RunConfig& config, const Scene& scene, int steps,
                                                     std::size_t most, const RunLimits& limits) {
  std::vector<PrescribedCrossing> out;
  if (!may_cross(scene)) return out;
  const double dt = config.time.dt;
  const audit::AuditMesh mesh = prescribed_part(audit_mesh_of(config, scene));
  if (mesh.points.empty()) return out;  // no more than obstacles are prescribed
  const double tolerance = audit_tolerance(scene, config.contact.min_gap_fraction);
  double last_end = 0;  // from then on every motion has ended
  for (const PrescribedMotion& motion : scene.motions) last_end = std::max(last_end, motion.last_change());
  std::optional<audit::Audit> judge(std::in_place, mesh);
  Positions x0 = scene.x0, x1 = x0;
  std::string before;
  for (int step = 0; step < steps && step * dt < last_end && out.size() < most; ++step) {
    limits.look_up("start check", fmt::format("in the prescribed motions, at step {} of {}", step, steps));
    for (const Pin& pin : scene.pins) x1.col(pin.vertex) = pin_pose(scene, pin, (step + 1) * dt);
    judge->check_motion(x0, x1, step, tolerance);
    judge->check_state(x1, step);
    x0 = x1;
    const audit::AuditLedger& ledger = judge->ledger();
    if (ledger.scene_faults == 0) {
      before.clear();
      continue;
    }
    const std::string pair = ledger.first_fault ? describe(scene, mesh, *ledger.first_fault) : "a pair";
    if (pair != before) out.push_back({step, step * dt, (step + 1) * dt, pair});
    before = pair;
    judge.emplace(mesh);
  }
  return out;
}

}  // namespace bb
