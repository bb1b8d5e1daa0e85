// The plan of a run: what its scene and its options need, and why. Filled once; whatever is not needed is
// neither allocated nor run. `bench explain` prints it and the record keeps what was skipped.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/scene/scene.hpp"

namespace bb {

struct PlanItem {
  bool needed = false;
  std::string reason;  // one clause, whichever way it went
};

/// What the options outside the scene decide.
struct PlanOptions {
  bool strain_limit = false;            // strain_limit.enabled
  bool mollifier = true;                // contact.mollifier is not none
  bool policy_needs_submatrix = false;  // contact or limit policy reads H
  bool collision_free_steps = true;     // false for a step solver without a step bound
  bool iterative_solver = false;        // linear solver is iterative
  bool diagnose = false, audit = false, trace = false, frames = false, matrices = false;
};

struct Plan {
  PlanItem contact;           // any contact at all: contact table, shape, stiffness policy
  PlanItem broad_phase;       // pairs of surfaces
  PlanItem step_bound;        // ACCD along every step
  PlanItem self_contact;      // a deformable body against itself or another one
  PlanItem given_surfaces;    // static or driven meshes: columns of contacts without unknowns
  PlanItem obstacles;         // analytic obstacles
  PlanItem mollifier;         // near-parallel edge-edge pairs
  PlanItem membrane;          // membrane elements
  PlanItem springs;           // edge springs
  PlanItem hinges;            // bending
  PlanItem strain_limit;      // limit energy and its exact step bound
  PlanItem pins;              // eliminated degrees of freedom
  PlanItem pin_lifting;       // prescribed motion on the right-hand side
  PlanItem planar_lock;       // third axis eliminated
  PlanItem policy_submatrix;  // w^T H w of every contact
  PlanItem preconditioner;    // iterative solver only
  PlanItem conditioning;      // condition numbers
  PlanItem audit;             // exact penetration checks
  PlanItem trace;             // one line a Newton iteration
  PlanItem frames, matrices;  // files beside the record

  /// (name, item) in the order above; the names are those of the members.
  std::vector<std::pair<std::string_view, const PlanItem*>> items() const;
  struct Skip {
    std::string what, why;
  };
  std::vector<Skip> skipped() const;
};

/// Errors: none.   Cost: O(vertices + elements).
Plan make_plan(const Scene& scene, const PlanOptions& options);

}  // namespace bb
