#include "core/audit/step_end.hpp"

#include <algorithm>

#include "core/audit/surface_gap.hpp"

namespace bb::audit {
namespace {

/// The obstacle with its surface moved away from the allowed side, at most by half of a radius.
AuditObstacle smaller(AuditObstacle o, double by) {
  if (o.kind == ObstacleKind::plane) {
    o.point -= by / o.axis.norm() * o.axis;
  } else {
    o.radius += o.inside ? by : -std::min(by, o.radius / 2);
  }
  return o;
}

}  // namespace

StepEnds::StepEnds(const AuditMesh& mesh, double promised) : mesh_(mesh) {
  mesh_.thickness.clear();
  inner_ = within_ = mesh_;
  for (AuditObstacle& o : within_.obstacles) o = smaller(o, promised);
  for (AuditObstacle& o : inner_.obstacles) o = smaller(o, o.allows_a_convex_set() ? promised : o.radius / 2);
}

StepEndAudit StepEnds::judge(const ObstaclePrimitives& primitives, const Positions& x0,
                             const Positions& x1) const {
  StepEndAudit out;
  out.obstacles = audit_obstacles(within_, primitives, x1);
  const ObstacleAudit exact = audit_obstacles(mesh_, primitives, x1);
  out.obstacles.scene_faults = exact.scene_faults;  // what is prescribed was promised nothing
  out.obstacles.first_fault = exact.first_fault;
  out.overlaps = std::max(0L, exact.violations - out.obstacles.violations);
  if (out.overlaps > 0) out.deepest_m = std::max(0.0, -judged_obstacle_gap(mesh_, primitives, x1));
  if (out.obstacles.violations > 0) return out;
  ObstacleAudit way = audit_obstacles(within_, primitives, x0, x1);
  const long open = way.violations + way.unproven;
  if (open > 0) way = audit_obstacles(inner_, primitives, x0, x1);
  out.corners_cut = std::max(0L, open - way.violations - way.unproven);
  way.scene_faults = 0;
  way.first_fault.reset();
  out.obstacles.merge(way);
  return out;
}

}  // namespace bb::audit
