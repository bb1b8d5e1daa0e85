// Obstacles at the ends of steps, for a step solver that promises how far a surface may be beyond them there, and nothing in between.
#pragma once

#include <optional>

#include "core/audit/obstacle_audit.hpp"

namespace bb::audit {

struct StepEndAudit {
  ObstacleAudit obstacles;  // what breaks the promise
  long overlaps = 0;        // primitives beyond an obstacle at the end by no more than was promised
  double deepest_m = 0;     // of these; rounded
  long corners_cut = 0;     // ways beyond a sphere or a cylinder that go round it
};

class StepEnds {
 public:
  /// promised: m, > 0.
  StepEnds(const AuditMesh& mesh, double promised);
  /// Of a step from x0 to x1 [3 n_vertices], m; finite. The end is judged against obstacles that are smaller by what was promised,
  /// exactly. The way is judged as straight: where its ends are allowed, one that goes beyond a sphere or a cylinder passes through it
  /// if it comes within half of the radius. Else it cuts a corner: moved away from the centre as far as the radius, it is a way of the
  /// same ends that goes round.
  StepEndAudit judge(const ObstaclePrimitives& primitives, const Positions& x0, const Positions& x1) const;

 private:
  AuditMesh mesh_, within_, inner_;  // without thickness; with smaller obstacles; with half of the radius
};

}  // namespace bb::audit
