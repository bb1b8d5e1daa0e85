// One accepted motion x0 -> x1, linear, both ends as rounded: every non-adjacent vertex-triangle
// and edge-edge pair (planar: vertex and boundary edge) certified free, or proven to pass through,
// or left unproven.
#pragma once

#include <optional>
#include <vector>

#include "core/audit/obstacle_audit.hpp"
#include "core/audit/surface.hpp"

namespace bb::audit {

struct MotionAudit {
  long pairs = 0;    // whose swept boxes meet and of which a vertex moved; = certified +
                     // violations + unproven + those of scene_faults
  long queries = 0;  // primitives compared with all that they may meet, by boxes at least
  long certified = 0, violations = 0, unproven = 0;
  ObstacleCounts obstacle_judged;  // primitives in motion compared with an obstacle
  long obstacle_violations = 0;    // of which a point is strictly beyond an obstacle somewhere on the way
  long obstacle_by_vertex = 0;     // those in which a vertex is beyond it
  long obstacle_unproven = 0;      // edges and triangles that could not be certified free of an obstacle
  long scene_faults =
      0;               // the same where prescribed vertices alone decide: violations, unproven, paths beyond
  bool finite = true;  // false: nothing was judged
  std::optional<PairName> first_bad, first_fault;
  void merge(const MotionAudit& other);
};

/// Judges the motion x0 -> x1 [3 n_vertices], m. A pair none of whose vertices moves is left to the state's
/// audit; one whose vertices all move as one rigid body keeps its distances and is not judged.
/// @param vertices   the colliding vertices, as from colliding_vertices(mesh)
/// @param primitives as from obstacle_primitives(mesh)
/// @param tolerance  m; see judge() in pair_verdict.hpp
/// Deterministic. Cost: O(n log n + pairs), about a millisecond per thousand pairs on one thread.
MotionAudit audit_motion(const AuditMesh& mesh, const std::vector<int>& vertices,
                         const ObstaclePrimitives& primitives, const Positions& x0, const Positions& x1,
                         double tolerance);
MotionAudit audit_motion(const AuditMesh& mesh, const Positions& x0, const Positions& x1, double tolerance);

}  // namespace bb::audit
