// What an iteration, a step and an observer say to each other: plain numbers, no JSON.
#pragma once

#include <optional>
#include <string>

#include "core/contact/contact_system.hpp"
#include "core/linear/linear_solver.hpp"
#include "core/newton/step_status.hpp"
#include "core/record/phase_times.hpp"
#include "core/record/trace_row.hpp"

namespace bb {

struct IterationReport {
  int step = 0, iteration = 0;  // 0-based
  double energy = 0;            // J, at the start of the iteration; contact with the kappa of this iteration
  double energy_change = 0;     // J, accepted
  double grad_inf = 0;          // N, free degrees of freedom
  double dx_inf = 0;            // m, Newton direction
  double decrement = 0;         // J, -g . dx
  double alpha = 0, alpha_ccd = 1, alpha_limit = 1;
  int line_search_trials = 0;
  bool accepted_by_rounding = false;  // |change of E| below 64 eps sum |terms|
  LinearReport linear;
  ContactCounts contacts;
  double gap_min = 0, gap_min_rel = 0;  // m, d/d_hat; infinity without contacts
  double kappa_min = 0, kappa_max = 0;  // N/m
  /// Largest max/min - 1 of a contact's kappa, and of an active limited element's, since the line search
  /// before; 0 in iteration 0.
  double kappa_change = 0, limit_kappa_change = 0;
  double limit_gap_min_rel = 0;     // smallest distance of a limited element to its limit, over the width
  double curvature_max = 0;         // N/m, largest m kappa b''
  double force_max = 0;             // N, largest kappa |b'| per unit multiplicity
  double limit_tension = 0;         // N/m, largest (1/area) dS_e/dsigma
  std::size_t n_free = 0, nnz = 0;  // of the matrix
  double max_stretch = 0;           // largest singular value of limited elements; 0 without
  bool pattern_changed = false;
  StepBound bound;
  PhaseTimes times;  // from its assembly to its end, what observers of the matrix took included
};

struct StepReport {
  int step = 0;
  double t = 0, dt_used = 0;  // s, at the end; accumulated_toi may shorten the step
  StepStatus status = StepStatus::converged;
  std::string detail;  // names the pin, the pair, the linear status
  int iterations = 0, linear_iterations = 0, line_search_trials = 0, factorizations = 0, analyses = 0;
  int accepted_by_rounding = 0;
  double kappa_change = 0, limit_kappa_change = 0;  // of the last iteration
  /// Last iterations in a row in which a contact's kappa, a limited element's, changed by more than 1 %.
  int kappa_unsettled = 0, limit_kappa_unsettled = 0;
  double alpha_min = 1, alpha_ccd_min = 1;
  long long ccd_queries = 0, ccd_probes = 0, ccd_capped = 0, ccd_zero = 0;
  ContactCounts contacts;        // at the end of the step
  double gap_min = 0;            // m
  double force_max = 0;          // N, largest kappa |b'| per unit multiplicity at the end of the step
  double limit_tension_max = 0;  // N/m, largest (1/area) dS_e/dsigma
  // of a step without progress: largest load / capacity over contact rows, and over limited elements; 0 when
  // the capacity is unbounded, absent when it was not measured
  std::optional<double> overload, limit_overload;
  double max_stretch = 0;
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
