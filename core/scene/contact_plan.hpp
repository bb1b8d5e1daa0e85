// Which contacts a scene can have at all: decided here once, read by the plan, the broad phase and the terms.
#pragma once

#include <string>

#include "core/scene/scene.hpp"

namespace bb {

struct PlanItem {
  bool needed = false;
  std::string reason;  // one clause, whichever way it went
};

/// needed with `yes`, or not with `no`.
PlanItem plan_item(bool needed, std::string yes, std::string no);

struct ContactPlan {
  PlanItem self_contact;    // a deformable body against itself or another one
  PlanItem given_surfaces;  // static or driven meshes: columns of contacts without unknowns
  PlanItem obstacles;       // analytic obstacles
  // kinds of pairs of surfaces, with at least one free vertex and none in common
  bool point_point = false, point_edge = false, point_triangle = false, edge_edge = false;

  bool pairs() const { return point_point || point_edge || point_triangle || edge_edge; }
  bool any() const { return pairs() || obstacles.needed; }
};

/// Errors: none.   Cost: O(surface log surface).
ContactPlan plan_contact(const Scene& scene);

}  // namespace bb
