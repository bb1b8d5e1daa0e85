// A method: formulation + integrator + step solver + linear solver, every default filled in. What differs
// between two runs of a comparison is here and in the scene.
#pragma once

#include <memory>
#include <string>

#include "core/integrators/integrator.hpp"
#include "core/linear/linear_solver.hpp"
#include "core/terms/term_options.hpp"

namespace bb {

struct StepSolverOptions {
  std::string name = "line_search";
  int max_iterations = 200;
  double tol_velocity = 0;  // m/s: stop at |dx|_inf / h below it
  double armijo = 1e-4;
  double cap_fraction = 0.8;  // line_search: part of a binding contact or strain bound that is taken
  // accumulated_toi
  double target_toi = 0.25;
  int min_iterations = 1;
  double max_dx = 1;        // m
  double extension = 1.25;  // a full step must be free along this multiple of itself
};

struct Method : TermOptions {
  std::unique_ptr<Integrator> integrator;
  StepSolverOptions step_solver;
  LinearOptions linear;
};

}  // namespace bb
