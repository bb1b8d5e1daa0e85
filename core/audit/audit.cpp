// Checks its input once, then only counts.
#include "core/audit/audit.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "core/audit/predicates.hpp"
#include "core/audit/surface_edges.hpp"
#include "core/math/error.hpp"

namespace bb::audit {
namespace {

void require_obstacles(const AuditMesh& mesh) {
  for (std::size_t i = 0; i < mesh.obstacles.size(); ++i) {
    const AuditObstacle& o = mesh.obstacles[i];
    const std::string where = "audit obstacle " + std::to_string(i);
    if (o.kind != ObstacleKind::plane && !(o.radius > 0.0 && o.radius < 1e100)) {
      throw ConfigError(where, "radius " + std::to_string(o.radius), "a finite number > 0");
    }
    if (o.kind != ObstacleKind::sphere && !(o.axis.allFinite() && o.axis.norm() > 0.0)) {
      throw ConfigError(where, "axis or normal without direction", "a finite vector that is not zero");
    }
    const bool given =
        static_cast<std::size_t>(o.vertex) < mesh.prescribed.size() && mesh.is_prescribed(o.vertex);
    if (o.moves() && !given) {
      throw ConfigError(where, "moves with vertex " + std::to_string(o.vertex), "a prescribed vertex");
    }
    if (!o.point.allFinite()) throw ConfigError(where, "point that is not finite", "three finite numbers");
  }
}

void require_indices(const AuditMesh& mesh, const std::vector<int>& vertices) {
  const int lowest = mesh.triangles.size() > 0 ? mesh.triangles.minCoeff() : 0;
  const int highest = mesh.triangles.size() > 0 ? mesh.triangles.maxCoeff() : 0;
  if (lowest < 0 || (!vertices.empty() && vertices.front() < 0)) {
    throw ConfigError("audit mesh", "a negative vertex index", "indices >= 0");
  }
  const int top = vertices.empty() ? highest : std::max(highest, vertices.back());
  for (const std::size_t n : {mesh.judged.owner.size(), mesh.fixed.size(), mesh.prescribed.size(),
                              mesh.motion.size(), mesh.thickness.size()}) {
    if (n > 0 && static_cast<std::size_t>(top) >= n) {
      throw ConfigError("audit mesh", "vertex " + std::to_string(top), "below the number of flags");
    }
  }
  if (!mesh.opposite.empty() && static_cast<Eigen::Index>(mesh.opposite.size()) != mesh.edges.cols()) {
    throw ConfigError("audit mesh", std::to_string(mesh.opposite.size()) + " opposite vertices",
                      "one an edge, or none");
  }
}

}  // namespace

Audit::Audit(AuditMesh mesh, double promised_overlap)
    : mesh_(std::move(mesh)), vertices_(colliding_vertices(mesh_)) {
  require_indices(mesh_, vertices_);
  ledger_.self_test_passed = predicates_self_test();
  ledger_.only_points = mesh_.only_points;
  require_obstacles(mesh_);
  primitives_ = obstacle_primitives(mesh_);
  ledger_.subjects = {mesh_.edges.cols(), mesh_.triangles.cols(), static_cast<long>(vertices_.size()),
                      static_cast<long>(mesh_.obstacles.size()), primitives_.needed(mesh_)};
  if (promised_overlap > 0 && !mesh_.obstacles.empty()) {
    ends_.emplace(mesh_, promised_overlap);
    pairs_ = mesh_;
    pairs_.obstacles.clear();
  }
  if (mesh_.judged.late.empty()) return;
  late_ = early_ = ends_ ? pairs_ : mesh_;
  late_->judged = mesh_.judged.in(Scope::at_step_ends, vertices_);
  early_.judged = mesh_.judged.in(Scope::within_steps, vertices_);
}

StateAudit Audit::check_state(const Positions& x, int step) {
  const bool first = ledger_.states == 0;
  const AuditMesh& all = ends_ ? pairs_ : mesh_;
  StateAudit found = audit_state(first ? all : in_motions(), primitives_, x, first);
  ledger_.add(found, step);
  return found;
}

MotionAudit Audit::check_motion(const Positions& x0, const Positions& x1, int step, double tolerance) {
  MotionAudit found = audit_motion(in_motions(), vertices_, primitives_, x0, x1, tolerance);
  ledger_.add(found, step);
  return found;
}

void Audit::check_step_end(const Positions& x0, const Positions& x1, int step, double tolerance) {
  if (!x0.allFinite() || !x1.allFinite()) return;
  if (ends_) ledger_.add(ends_->judge(primitives_, x0, x1), step);
  if (!late_ || all_motions_ || step < 0) return;  // the start is judged whole by check_state
  const StateAudit end = audit_state(*late_, primitives_, x1, false);
  ledger_.add_late(end, audit_motion(*late_, vertices_, primitives_, x0, x1, tolerance), step);
}

}  // namespace bb::audit
