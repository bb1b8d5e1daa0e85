// How close the whole surface comes to the obstacles and to itself in one state, thickness taken off: a number beside
// the exact signs, by the audit's own distances.
#pragma once

#include <limits>
#include <vector>

#include "core/audit/obstacle_audit.hpp"
#include "core/audit/surface.hpp"

namespace bb::audit {

/// In m, negative where thick surfaces overlap; infinity: nothing to measure, or nothing within reach. In double: wrong
/// by a few ulps of the coordinates. `between` knows no sign of surfaces without thickness: where they cross it is small,
/// and the crossing is what the state's audit counts.
struct SurfaceGap {
  double to_obstacles = std::numeric_limits<double>::infinity();
  double between = std::numeric_limits<double>::infinity();
  /// Of each colliding vertex the gap to the closest triangle (planar: edge) of which it is no corner and that is not
  /// prescribed together with it.
  std::vector<double> of_vertices;
};

/// Of the state x [3 n_vertices], m. Obstacles: the closest point of every primitive that obstacle_primitives() lists.
/// Between: all pairs that share no vertex, vertex and triangle or edge and edge (planar: vertex and edge), that are
/// closer than `reach` (m). Left out is what only prescribed vertices decide. Thickness of a primitive: the mean of its
/// vertices'. Deterministic. Cost: that of a state's audit with boxes wider by reach and thickness.
/// @param vertices the colliding vertices
SurfaceGap surface_gap(const AuditMesh& mesh, const std::vector<int>& vertices,
                       const ObstaclePrimitives& primitives, const Positions& x, double reach);

/// SurfaceGap::to_obstacles alone.
double judged_obstacle_gap(const AuditMesh& mesh, const ObstaclePrimitives& primitives, const Positions& x);

}  // namespace bb::audit
