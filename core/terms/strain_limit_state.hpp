// What the strain limit of triangles, or of tetrahedra, is at an iterate and at a trial, on any executor: which state is measured, when
// the stiffness is made anew, how far a motion may go, what is reported of it. The host's term and an executor's share it.
#pragma once

#include <memory>
#include <string_view>

#include "core/energy/families/limit_family.hpp"
#include "core/exec/sums/executor_sum.hpp"
#include "core/terms/report.hpp"
#include "core/terms/term_options.hpp"

namespace bb {

/// The calls of a step come in this order: begin_step; of an iterate refresh, then what is reported of it and motions from it; of a trial
/// look_at, is_feasible, evaluate; accept where it becomes the iterate. Pointers are memory of the executor; x: [3 n_vertices] m;
/// energy: [n] J, of the state x, written where it has to be measured.
class StrainLimitState {
 public:
  /// scene and options outlive it, vertex_mass [n_vertices] (kg) too. Errors: those of limited_triangles; ConfigError
  /// for a policy that serves no strain limit; std::logic_error where kappa has a potential and the barrier has none.
  StrainLimitState(exec::Executor& executor, const Scene& scene, const TermOptions& options, bool of_solids,
                   const double* vertex_mass);
  LimitFamily& family() { return *family_; }
  const LimitFamily& family() const { return *family_; }
  bool of_solids() const { return of_solids_; }
  const StiffnessPolicy& policy() const {
    return of_solids_ ? *options_.solid_limit_stiffness : *options_.limit_stiffness;
  }
  /// Whether triangles have reported their part before.
  bool adds() const { return adds_; }

  /// x_n is valid for the step.
  void begin_step(const double* x_n, const StiffnessTime& time);
  void set_time(const StiffnessTime& time) { time_ = time; }

  // --- an iterate
  /// Whether the next refresh() reads H.
  bool asks_for_elastic() const { return !keeps_kappa() && policy().needs_hessian(); }
  /// kappa as its rule has it, and barrier terms.
  void refresh(const double* x, const ElasticMatrix& elastic, double* energy);
  void measure_iterate(const double* x, double* energy);

  // --- a motion
  /// Launches what bound() reads.
  void look_along(const double* x, const double* dx);
  /// Largest alpha in [0, 1] up to which the motion is feasible. Waits.
  double bound(IterateNumbers& out);
  /// What held the last bound() below 1.
  std::string_view describe_bound() const {
    return of_solids_ ? "the strain limit of solids" : "the strain limit";
  }

  // --- a trial
  /// Launches what is_feasible() reads.
  void look_at(const double* trial, double* energy);
  /// Waits.
  bool is_feasible() const;
  /// Energies of a trial; of the one that was looked at last nothing is left to do.
  void evaluate(const double* trial, double* energy);
  /// The trial becomes the iterate.
  void accept();
  /// The family has measured some other state.
  void forget() { measured_ = State::none; }

  // --- what is reported of the iterate
  /// Launches what report() and report_end() read.
  void announce(const double* x, double* energy);
  void report(const double* x, double* energy, IterateNumbers& out);
  void report_end(const double* x, double* energy, StepNumbers& out);

 private:
  enum class State { none, iterate, trial };
  bool keeps_kappa() const { return fresh_ && policy().frozen_in_step(); }
  void measure(const double* x, double* energy, State state);
  LimitReport numbers(const double* x, double* energy);

  const TermOptions& options_;
  const bool of_solids_, adds_;
  const double* vertex_mass_;
  std::unique_ptr<LimitFamily> family_;
  exec::ExecutorLeast beyond_;  // the first element at or beyond its limit
  StiffnessTime time_;
  const double* x_n_ = nullptr;
  State measured_ = State::none;
  bool looked_at_ = false;             // the trial was, and not evaluated since
  bool accepted_ = false;              // the iterate was a trial, and was not refreshed yet
  bool announced_ = false;             // numbers are of the iterate
  bool fresh_ = false, first_ = true;  // kappa is that of this step; no iterate of the step was refreshed
  double kappa_change_ = 0;            // of the last refresh()
};

}  // namespace bb
