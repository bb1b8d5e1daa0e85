// Newton with a line search on E, for step solvers that differ in what bounds its motions.
#pragma once

#include <functional>
#include <memory>

#include "core/newton/step_solver.hpp"

namespace bb {

struct LineSearchRules {
  double cap_fraction = 1;  // of a bound that binds, in (0, 1]; not read without a bound
  bool bounded = true;      // by ACCD and the strain limit; false: trials are judged as states alone
  /// N; where > 0, E counts as minimised where the norm of its gradient was below it before the last motion, too.
  double gradient_tolerance = 0;
  /// After a motion that was accepted: whether E is another one now, so that the step goes on from there.
  std::function<bool(StepSystem&)> after_motion = {};
};

/// options: with `armijo`. Its steps say four counters, `feasibility_trials`, `truncations`, `lengthened` and `secants`.
std::unique_ptr<StepSolver> make_line_search(const StepSolverOptions& options, const LineSearchRules& rules);

}  // namespace bb
