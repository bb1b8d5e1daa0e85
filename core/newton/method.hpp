// A method: formulation + integrator + step solver + linear solver, every default filled in. What differs
// between two runs of a comparison is here and in the scene.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/parameters/parameter.hpp"
#include "core/linear/linear_solver.hpp"
#include "core/model/integrators/integrator.hpp"
#include "core/newton/saddle_rule.hpp"
#include "core/newton/step_size.hpp"
#include "core/terms/step_hessian.hpp"
#include "core/terms/step_needs.hpp"
#include "core/terms/term_options.hpp"

namespace bb {

class IncrementalPotential;
class PhaseClock;
struct Method;
struct Plan;
struct Scene;

/// Makes E of a scene in the memory of some executor. fixed: [3 n] prescribed or locked degrees of freedom. All arguments
/// outlive it.
using MakePotential = std::function<std::unique_ptr<IncrementalPotential>(
    const Scene&, Method&, const Plan&, const std::vector<std::uint8_t>& fixed, PhaseClock&)>;

struct StepSolverOptions {
  std::string name = "line_search";
  int max_iterations = 200;
  double tol_velocity = 0;  // m/s: stop at |dx|_inf / h below it
  SaddleRule saddle = SaddleRule::escape;
  int retries = 0;          // times that a step is halved and tried again, 0 to 20
  ParameterMap parameters;  // of the step solver of that name; what is left out has its default
};

struct Method : TermOptions {
  std::map<std::string, StepHessian, std::less<>> step_hessian;  // by term; what is left out is clamped
  /// That of a term.
  StepHessian hessian_of(std::string_view term) const {
    const auto found = step_hessian.find(term);
    return found == step_hessian.end() ? StepHessian::clamped : found->second;
  }
  std::unique_ptr<Integrator> integrator;
  StepSolverOptions step_solver;
  StepSizeOptions step_size;
  StepNeeds step_needs;  // of the step solver (fit_terms, choose_step_solver)
  LinearOptions linear;
  /// Where E is summed and solved; empty: on the host (HostEngine).
  MakePotential make_potential;
};

}  // namespace bb
