// A method: formulation + integrator + step solver + linear solver, every default filled in. What differs
// between two runs of a comparison stands here and in the scene, nowhere else.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "core/contact/contact_system.hpp"
#include "core/contact/shape.hpp"
#include "core/contact/stiffness_policy.hpp"
#include "core/energy/strain_stiffness.hpp"
#include "core/integrators/integrator.hpp"
#include "core/linear/linear_solver.hpp"
#include "core/parameters/parameter.hpp"

namespace bb {

/// Stiffness of the strain limit, J per element.
struct LimitStiffness {
  enum class Kind { fixed, elasticity_inclusive };
  Kind kind = Kind::fixed;
  double k_s = 0;                        // N/m, fixed: kappa_e = k_s x rest area
  MassTerm mass_term = MassTerm::paper;  // elasticity_inclusive
  bool elastic_term = true;              // elasticity_inclusive
  Refresh refresh = Refresh::per_iteration;
  double multiplier = 1;  // the config's own factor times s of the matching rule

  /// What elasticity_inclusive asks of one element, in a step of length dt (s) and inertia weight c.
  StrainStiffnessRule rule(double dt, double c) const { return {mass_term, elastic_term, dt, c}; }
  bool needs_hessian() const { return kind == Kind::elasticity_inclusive && elastic_term; }
};

struct StepSolverOptions {
  std::string name = "line_search";
  int max_iterations = 200;
  double tol_velocity = 0;  // m/s: stop at |dx|_inf / h below it
  ParameterMap parameters;  // of the step solver of that name; what is left out has its default
};

struct Method {
  BarrierFunction contact;
  std::unique_ptr<StiffnessPolicy> stiffness;
  BarrierFunction limit;
  LimitStiffness limit_stiffness;
  HessianMode hessian_mode = HessianMode::gauss_newton;
  ContactOptions contact_options;
  std::unique_ptr<Integrator> integrator;
  StepSolverOptions step_solver;
  LinearOptions linear;
  bool keep_elastic_matrix = false;  // snapshot H even when no policy reads it (diagnostics, matching)
};

}  // namespace bb
