// The plan of a run: what its scene and its options need, and why. Made once. Terms are made from it, the
// contact module reads its contact plan, the system H, pins and axes. Step bound, preconditioner and passes are
// decided by options and only described here. `bench explain` prints it and the record keeps every item.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/linear/linear_solver.hpp"
#include "core/model/scene/contact_plan.hpp"
#include "core/model/scene/scene.hpp"
#include "core/terms/registry.hpp"
#include "core/terms/step_needs.hpp"

namespace bb {

/// What the options outside the terms decide.
struct PlanOptions {
  StepNeeds step;         // of the step solver
  bool end_check = true;  // the end of a step is tested for a minimum
  LinearOptions linear;   // a registered solver
  std::string linear_reason = "as requested";
  bool diagnose = false, audit = false, trace = false, frames = false, matrices = false;
};

struct Plan {
  std::vector<PlanItem> terms;  // of term_entries(), in their order
  ContactPlan contacts;         // what contact is made of
  PlanItem step_bound;          // ACCD along every step
  PlanItem trial_energies;      // E at the states that a line search tries
  PlanItem end_check;           // whether a step ends in a minimum of E
  PlanItem policy_submatrix;    // H, which a stiffness policy reads
  PlanItem pins;                // eliminated degrees of freedom
  PlanItem pin_lifting;         // prescribed motion on the right-hand side
  PlanItem planar_lock;         // third axis eliminated
  PlanItem float_arithmetic;    // what is computed in float
  PlanItem linear_solver;       // which, and why
  PlanItem preconditioner;      // iterative solver only
  PlanItem conditioning;        // condition numbers
  PlanItem audit;               // exact penetration checks
  PlanItem trace;               // one line a Newton iteration
  PlanItem frames, matrices;    // files beside the record
  LinearOptions linear;         // what linear_solver says

  /// That of the term of this name. Requires a name of term_entries().
  const PlanItem& term(std::string_view name) const;
  /// (name, item): the terms, then the others in the order above; the names are those of the members.
  std::vector<std::pair<std::string_view, const PlanItem*>> items() const;
};

/// Errors: none.   Cost: O(vertices + elements + surface log surface).
Plan make_plan(const Scene& scene, const TermOptions& terms, const PlanOptions& options);

/// The terms that the plan needs, in the order of registry.inc.
TermList make_terms(const Plan& plan, const TermInputs& inputs);

}  // namespace bb
