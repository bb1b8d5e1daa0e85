// Single time steps of a run, each from one state, once with every choice of Hessian: what a choice costs and
// how far from the solution it stops. End states of whole runs cannot say that, since a step that buckles has
// several minima and runs part.
#pragma once

#include <string>
#include <vector>

#include "core/base/record/step_status.hpp"
#include "experiments/run/runner.hpp"

namespace bb {

/// One step with one choice for all terms.
struct StepTrial {
  int step = 0;         // of the run, from 0
  std::string hessian;  // a word of StepHessian
  StepStatus status = StepStatus::converged;
  int newton_iterations = 0;
  long long linear_solves = 0, hessian_fallbacks = 0;
  double tolerance_m = 0;        // h tol_velocity
  Number error_estimate_m;       // of the end, by the solver
  Number error_true_m;           // |x - x_ref|_inf against the same step at a thousandth of the tolerance;
                                 // absent where that did not converge
  std::vector<double> dx_inf_m;  // one an iteration
  std::size_t contacts = 0;      // rows at the end
  std::string state_hash;        // sha256 of the end positions
};

/// Runs the config to the start of each of `steps` (ascending, from 0), then each step with each choice from
/// that state. The states are the config's own, and so is what policies remember: with the choice of the run itself a
/// trial is the run's step, bit for bit.
/// Errors: as run_config; ConfigError when a step is beyond the run, or the run does not get there.
std::vector<StepTrial> study_steps(const RunConfig& config, const std::vector<int>& steps,
                                   const RunOptions& options);

/// {"schema": "barrierbench.steps/1", "config": resolved, "trials": [...]}; numbers that are absent are null.
std::string to_json(const RunConfig& config, const std::vector<StepTrial>& trials);

}  // namespace bb
