// What was found at obstacles, as a part of the audit of a state or of a motion.
#pragma once

#include "core/audit/obstacle_audit.hpp"
#include "core/audit/tally.hpp"

namespace bb::audit {

/// Once for each audit. Motions that are not proven are the caller's: a state has none.
template <class Audit>
void add_obstacles(const ObstacleAudit& found, Audit& out) {
  out.obstacle_judged = found.judged;
  out.obstacle_violations = found.violations;
  out.obstacle_by_vertex = found.by_vertex;
  out.scene_faults += found.scene_faults;
  keep_first(out.first_bad, found.first_bad);
  keep_first(out.first_fault, found.first_fault);
}

}  // namespace bb::audit
