// One accepted motion x0 -> x1, linear, both ends as rounded: every non-adjacent vertex-triangle
// and edge-edge pair (planar: vertex and boundary edge) certified free, or proven to pass through,
// or left unproven.
#pragma once

#include <optional>

#include "core/audit/surface.hpp"

namespace bb::audit {

struct MotionAudit {
  long pairs = 0;    // whose swept boxes meet and of which a vertex moved; = certified +
                     // violations + unproven + those of scene_faults
  long queries = 0;  // primitives compared with all that they may meet, by boxes at least
  long certified = 0, violations = 0, unproven = 0;
  long obstacle_queries = 0;     // paths of a vertex compared with an obstacle
  long obstacle_violations = 0;  // free vertices whose path is strictly beyond an obstacle somewhere
  long scene_faults = 0;  // the same where every vertex is prescribed: violations, unproven, paths beyond
  bool finite = true;     // false: nothing was judged
  std::optional<PairName> first_bad, first_fault;
  void merge(const MotionAudit& other);
};

/// Judges the motion x0 -> x1 [3 n_vertices], m. A pair none of whose vertices moves is left to the state's
/// audit.
/// @param vertices  the colliding vertices, as from colliding_vertices(mesh)
/// @param tolerance m; see judge() in pair_verdict.hpp
/// Deterministic. Cost: O(n log n + pairs), about a millisecond per thousand pairs on one thread.
MotionAudit audit_motion(const AuditMesh& mesh, const std::vector<int>& vertices, const Positions& x0,
                         const Positions& x1, double tolerance);

}  // namespace bb::audit
