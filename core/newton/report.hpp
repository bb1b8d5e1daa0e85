// What an iteration, a step and an observer say to each other: plain numbers, no JSON.
#pragma once

#include <string>

#include "core/linear/linear_solver.hpp"
#include "core/newton/step_status.hpp"
#include "core/record/phase_times.hpp"
#include "core/terms/report.hpp"

namespace bb {

struct IterationReport : IterateNumbers {
  int step = 0, iteration = 0;  // 0-based
  double energy = 0;            // J, at the start of the iteration; contact with the kappa of this iteration
  double energy_change = 0;     // J, accepted
  double grad_inf = 0;          // N, free degrees of freedom
  double dx_inf = 0;            // m, Newton direction
  double decrement = 0;         // J, -g . dx
  double alpha = 0;
  int line_search_trials = 0;
  bool accepted_by_rounding = false;  // |change of E| below 64 eps sum |terms|
  LinearReport linear;
  std::size_t n_free = 0, nnz = 0;  // of the matrix
  bool pattern_changed = false;
  PhaseTimes times;  // from its assembly to its end, what observers of the matrix took included
};

struct StepReport : StepNumbers {
  int step = 0;
  double t = 0, dt_used = 0;  // s, at the end; accumulated_toi may shorten the step
  StepStatus status = StepStatus::converged;
  std::string detail;  // names the pin, the pair, the linear status
  int iterations = 0, linear_iterations = 0, line_search_trials = 0, factorizations = 0, analyses = 0;
  int accepted_by_rounding = 0;
  double alpha_min = 1;
  double kinetic_energy = 0;  // J
  PhaseTimes times;           // every moment of Simulation::step; on_step sees what came before it
};

/// Looks on; every call is optional. Its time belongs to Phase::output.
class NewtonSystem;
class StepObserver {
 public:
  virtual ~StepObserver() = default;
  /// After assembly, before the solve: the matrices of this iteration are in `system`.
  virtual void on_matrix(NewtonSystem&, int /*step*/, int /*iteration*/) {}
  virtual void on_iteration(const IterationReport&) {}
  /// An accepted line search, as rounded.
  virtual void on_motion(const Positions& /*x0*/, const Positions& /*x1*/, int /*step*/) {}
  /// A finished step; `system` holds the contact table of its end state.
  virtual void on_step(NewtonSystem&, const StepReport&, const Positions& /*x*/) {}
};

}  // namespace bb
