// Which contacts a scene can have at all: decided here once, read by the plan, the broad phase and the terms.
#pragma once

#include <string>

#include "core/model/scene/scene.hpp"

namespace bb {

struct PlanItem {
  bool needed = false;
  std::string reason;  // one clause, whichever way it went
};

/// needed with `yes`, or not with `no`.
PlanItem plan_item(bool needed, std::string yes, std::string no);

/// Edges of the surface that are no side of one of its triangles (rods), each once with the lower vertex first, sorted.
std::vector<std::array<int, 2>> lone_edges(const Scene& scene);

/// What keeps the energy of nearly parallel edges, and of edges along a cylinder, smooth: the mollifier of Li et al. 2020 (IPC), or
/// nothing.
enum class Mollifier { ipc, none };

struct ContactPlan {
  PlanItem self_contact;    // a deformable body against itself or another one
  PlanItem given_surfaces;  // static or driven meshes: columns of contacts without unknowns
  PlanItem obstacles;       // analytic obstacles
  PlanItem collisions;      // pairs of bodies that do less than collide in full
  // kinds of pairs of surfaces, with at least one free vertex and none in common
  bool point_point = false, point_edge = false, point_triangle = false, edge_edge = false;

  PlanItem broad_phase;  // some kind of pair
  PlanItem mollifier;    // of pairs of two edges, and of an edge and a cylinder

  bool any() const { return broad_phase.needed || obstacles.needed; }
};

/// Errors: none.   Cost: O(vertices + surface), and a sort of the edges.
ContactPlan plan_contact(const Scene& scene, Mollifier mollifier = Mollifier::ipc);

}  // namespace bb
