// One accepted state: exact signs of every non-adjacent edge-triangle pair (planar: boundary edges),
// orientation of planar elements, and the side of every vertex to every obstacle.
#pragma once

#include <optional>

#include "core/audit/surface.hpp"

namespace bb::audit {

struct StateAudit {
  long pairs = 0;             // that met in the broad phase
  long queries = 0;           // primitives compared with all that they may meet, by boxes at least
  long obstacle_queries = 0;  // signs of a vertex to an obstacle
  long crossings = 0, touches = 0;
  long inverted = 0;             // planar elements with area <= 0
  long obstacle_violations = 0;  // free vertices strictly beyond an obstacle
  long scene_faults = 0;         // crossings of prescribed primitives, driven vertices beyond an obstacle
  bool finite = true;            // false: nothing was judged
  std::optional<PairName> first_bad;    // the lowest in PairName's order, touches aside
  std::optional<PairName> first_touch;  // the same of the touches
  std::optional<PairName> first_fault;  // the same of the scene's faults, which are in no other count
  void merge(const StateAudit& other);
};

/// Judges the state x [3 n_vertices], m. Pairs of wholly fixed primitives only if `include_fixed`; fixed
/// vertices are not judged against obstacles. Deterministic. Cost: O(n log n + pairs).
/// @param vertices the colliding vertices, as from colliding_vertices(mesh)
StateAudit audit_state(const AuditMesh& mesh, const std::vector<int>& vertices, const Positions& x,
                       bool include_fixed);

/// All vertices of edges and (in 3D) triangles and the listed points, ascending.
std::vector<int> colliding_vertices(const AuditMesh& mesh);

}  // namespace bb::audit
