// One accepted state: exact signs of every non-adjacent edge-triangle pair (planar: boundary edges), orientation of
// planar elements, and the whole surface against every obstacle.
#pragma once

#include <optional>
#include <vector>

#include "core/audit/obstacle_audit.hpp"
#include "core/audit/surface.hpp"

namespace bb::audit {

struct StateAudit {
  long pairs = 0;                  // that met in the broad phase
  long queries = 0;                // primitives compared with all that they may meet, by boxes at least
  ObstacleCounts obstacle_judged;  // primitives compared with an obstacle
  long crossings = 0;  // edges through triangles, touches that no displacement takes apart among them
  long touches = 0;    // pairs at distance 0 that an infinitely small displacement takes apart
  long inverted = 0;   // planar elements with area <= 0
  long obstacle_violations = 0;         // primitives with a point strictly beyond an obstacle
  long obstacle_by_vertex = 0;          // those in which a vertex is beyond it
  long scene_faults = 0;                // of prescribed primitives: crossings, and what is beyond an obstacle
  bool finite = true;                   // false: nothing was judged
  std::vector<PairName> touching;       // while pairs are collected; then decided, and empty
  std::vector<PairName> all;            // offenders one by one, of all_crossings() alone
  std::optional<PairName> first_bad;    // the lowest in PairName's order, touches aside
  std::optional<PairName> first_fault;  // the same of the scene's faults, which are in no other count
  std::optional<PairName> deepest;      // crossing of edge and triangle (3D), and how far the edge reaches
  double deepest_m = 0.0;               // through the triangle's plane, at its nearer end; rounded, m
  void add_crossing(const PairName& name, bool prescribed);
  void keep_deeper(const std::optional<PairName>& name, double depth_m);
  void merge(const StateAudit& other);
};

/// Judges the state x [3 n_vertices], m. Pairs within one rigid body only if `include_rigid`. Deterministic.
/// Cost: O(n log n + pairs).
/// @param primitives as from obstacle_primitives(mesh)
StateAudit audit_state(const AuditMesh& mesh, const ObstaclePrimitives& primitives, const Positions& x,
                       bool include_rigid);
StateAudit audit_state(const AuditMesh& mesh, const Positions& x, bool include_rigid);

/// Every pair that a state's audit counts as a crossing or as a violation of an obstacle, those of prescribed primitives
/// among them, and in the plane every inverted element; ascending, each once. x: finite.
std::vector<PairName> all_crossings(const AuditMesh& mesh, const Positions& x);

}  // namespace bb::audit
