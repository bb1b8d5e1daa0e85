// The whole surface against the analytic obstacles: which primitives have to be queried, and what was found of them in
// a state or along a motion.
#pragma once

#include <optional>
#include <vector>

#include "core/audit/surface.hpp"

namespace bb::audit {

/// Numbers of primitives by kind.
struct ObstacleCounts {
  long vertices = 0, edges = 0, triangles = 0;
  long total() const { return vertices + edges + triangles; }
  void add(const ObstacleCounts& other) {
    vertices += other.vertices, edges += other.edges, triangles += other.triangles;
  }
};

/// What has to be checked so that no point of the surface is left out.
struct PrimitiveLists {
  std::vector<int>
      vertices;  // against planes and `inside`: the allowed set is convex; and where points alone are judged
  std::vector<int> lone_vertices;  // outside spheres and cylinders: on no edge and no triangle
  std::vector<int> lone_edges;     // the same: sides of no triangle
  std::vector<int> triangles;      // the same; of planar scenes the elements
};

/// Of obstacles that stand still, and of those that move. Primitives whose vertices are all fixed are not judged against
/// the former: both are given, and still.
struct ObstaclePrimitives {
  PrimitiveLists of_still, of_moving;
  const PrimitiveLists& of(const AuditObstacle& obstacle) const {
    return obstacle.moves() ? of_moving : of_still;
  }
  /// Primitives that one check of a state needs, over all obstacles of the mesh.
  ObstacleCounts needed(const AuditMesh& mesh) const;
};
ObstaclePrimitives obstacle_primitives(const AuditMesh& mesh);

struct ObstacleAudit {
  ObstacleCounts judged;
  long violations = 0;    // primitives with a point strictly beyond an obstacle, at rest or on the way
  long by_vertex = 0;     // those of violations in which a vertex is beyond it, not only what lies between
  long unproven = 0;      // motions of edges and triangles that could not be certified
  long scene_faults = 0;  // either, where only prescribed vertices decide; in no other count
  std::optional<PairName> first_bad, first_fault;
  std::vector<PairName> all;  // offenders one by one, of all_beyond_obstacles() alone
  void merge(const ObstacleAudit& other);
};

/// The state x [3 n_vertices], m; finite. Exact. Cost: O(primitives x obstacles).
ObstacleAudit audit_obstacles(const AuditMesh& mesh, const ObstaclePrimitives& primitives,
                              const Positions& x);

/// Every primitive with a point strictly beyond an obstacle in the state x, prescribed ones too, by the name that
/// audit_obstacles() gives it; in no order.
std::vector<PairName> all_beyond_obstacles(const AuditMesh& mesh, const ObstaclePrimitives& primitives,
                                           const Positions& x);

/// The motion x0 -> x1, of the primitives of which a vertex moves, or past which the obstacle does; vertices exactly, the others as
/// judge_past_obstacle() says.
ObstacleAudit audit_obstacles(const AuditMesh& mesh, const ObstaclePrimitives& primitives,
                              const Positions& x0, const Positions& x1);

}  // namespace bb::audit
