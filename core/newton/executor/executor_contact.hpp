// The contact term in an executor's memory: its rows, their search and their sums, with memory that is given back where scenes are large.
#pragma once

#include <memory>
#include <optional>

#include "core/base/record/phase_times.hpp"
#include "core/contact/executor/contact_assembly.hpp"
#include "core/contact/executor/contact_sums.hpp"
#include "core/contact/executor/executor_barrier.hpp"
#include "core/contact/executor/executor_broad_phase.hpp"
#include "core/contact/executor/executor_step_bound.hpp"
#include "core/contact/executor/policy_kernels.hpp"
#include "core/contact/executor/row_finder.hpp"
#include "core/contact/executor/sum_kernels.hpp"
#include "core/contact/step_bound.hpp"
#include "core/terms/contact_steps.hpp"
#include "core/terms/executor/term_inputs.hpp"

namespace bb::exec {

class ExecutorContact final : public ContactSteps<ExecutorTerm> {
 public:
  /// Errors: ConfigError for a shape or a policy without a device form; OutOfMemory.
  explicit ExecutorContact(const ExecutorInputs& inputs);

  // --- a step
  void begin_step(const StepColumns& step, PhaseClock&) override;
  void end_step(const PositionsView& x, PhaseClock& clock) override;
  void drop_caches() override { matrix_ = {}; }

  // --- an iterate
  /// kappa and barrier of the rows at x too. Keeps H for trial states, since the matrix holds all terms by then.
  void linearise(const PositionsView& x, const ExecutorContext& context, PositionsSpan g) override;
  void add_matrix(const PositionsView& x, const HessianRequest& request) override;
  ChangingMatrix changing_matrix() const override { return {matrix_, assembly_.n_blocks()}; }
  bool pattern_changed() const override { return pattern_changed_; }
  void add_given_motion(const PositionsView& x, const PositionsView& motion, PositionsSpan force) override {
    settle(x);
    assembly_.add_given_motion(rows_, x, motion, force);
  }

  // --- a motion, and states on it
  void prepare(const Motion& motion, PhaseClock& clock) override;
  void look_along(const Motion& motion, PhaseClock& clock) override;
  /// Where it is frugal the lists of the motion are gone after that.
  bool add_curvature_correction(const PositionsView& x, const PositionsView& dx, double bound,
                                PositionsSpan force) override;
  bool sees_non_finite() const override { return true; }
  void look_at(const PositionsView& x, const PositionsView& trial, PhaseClock& clock) override;
  bool is_feasible(const PositionsView&, PhaseClock& clock) override;
  /// kappa of the trial.
  void freeze(PhaseClock&) override;
  /// Its barrier.
  void evaluate(const PositionsView& trial) override;
  /// Nothing: rows of an iterate have their barrier when somebody reads them.
  void evaluate_iterate(const PositionsView& /*x*/) override {}
  void add_change(const PositionsView& x, const PositionsView& trial, ExecutorChange& out) override;
  void add_rows(RowEnergies& out) override;
  void accept(PhaseClock&) override;

  // --- what later terms read of it, at the iterate x
  ExecutorRows& rows(const PositionsView& x) {
    settle(x);
    return rows_;
  }
  /// Rows with their barrier, and mollifiers; valid until the next call of anything else.
  RowEnergy forces(const PositionsView& x) { return assembly_.row_energy(rows(x), x); }
  const ExecutorSurface& surface() const { return executor_surface_; }

  // --- what is reported of it
  void add_energy(const PositionsView& x, ExecutorEnergy&) override { look_at_rows(x); }
  Compensated row_energy() override { return totals_.get().energy; }
  void add_known(KnownStep& out) const override;

  // --- memory
  void expect(const ExpectedContacts& expected) override;
  /// What a stage does not read: candidates and trial rows before a solve, matrix values before a motion.
  void set_frugal_from(Index rows) override { frugal_from_ = rows; }
  /// Of the candidate lists of a motion. A motion that needs more has none: its bound is found in the trees, and every
  /// state on it gets its own lists. Counters of the bound depend on it.
  void set_list_budget(std::size_t bytes) override { list_budget_ = bytes; }

 private:
  static constexpr Index default_frugal_from = Index{1} << 24;
  /// Twice the lists of 184 million contacts with two candidates each: more come of a motion that sweeps far, not of
  /// contacts.
  static constexpr std::size_t default_list_budget = std::size_t{8} << 30;
  bool frugal() const { return rows_.size() >= frugal_from_; }
  std::size_t list_budget() const;
  std::size_t count_candidates(const PositionsView& x0, const PositionsView& x1, std::size_t most);
  void fill_lists();
  void look_for_rows(const PositionsView& x);
  void find_rows(const PositionsView& x);
  void lend_columns();
  void settle(const PositionsView& x);
  void take_back(const PositionsView& x);
  void take_trial();
  void keep_elastic(const ExecutorContext& context);
  /// Launches the sums over the rows of the iterate, as linearise() or accept() left them.
  void look_at_rows(const PositionsView& x);
  RowTotals totals(const PositionsView& x) override;
  double smallest_gap() const override { return rows_.min_gap; }
  double largest_coordinate(const PositionsView& x) override { return vectors_.max(x); }
  void visit_rows(const PositionsView& x, const std::function<void(const EndRow&)>& f) override;
  double kappa_change() const override { return stiffness_.change(); }
  std::optional<StartSums> start_sums(const PositionsView& x, const PositionsView& others) override;
  StepBound find_bound(const Motion& motion) override;
  double policy_kappa() const { return policy().uniform() ? policy().state().kappa : 0; }
  void refresh_kappa();
  KernelKappa kappa_of(ExecutorRows& rows) {
    return {rows, executor_, *options_.stiffness, time_, mass_.data(), elastic_};
  }
  void give_back_motion();

  Executor& executor_;
  VectorTools& vectors_;
  const Buffer<double>& mass_;
  Surface surface_;
  ExecutorSurface executor_surface_;
  ExecutorCandidates candidates_;
  ExecutorBroadPhase broad_phase_;
  ExecutorStepBound step_bound_;
  RowFinder finder_;
  StiffnessUpdate stiffness_;
  ExecutorBarrier barrier_;
  ContactAssembly assembly_;
  RowSums sums_;
  ExecutorLeast curved_, straight_;  // HoldTimes
  ExecutorRows rows_, trial_;
  bool lent_ = false;                                // the trial has the columns that the two share
  bool evaluated_ = true, trial_evaluated_ = false;  // the rows have a barrier; those of the trial
  bool taken_ = false;     // the rows have the barrier of an accepted trial, and were not linearised
  bool looked_ = false;    // totals_ is of the iterate
  bool compared_ = false;  // the finder has compared the trial with the iterate
  Index frugal_from_ = default_frugal_from;
  std::size_t list_budget_ = default_list_budget;
  bool listed_ = false;    // the candidate lists are those of the motion
  bool in_trees_ = false;  // the trees are those of the motion, which has no lists
  Column part_;            // [3 n] gradient of B with kappa = 1
  Column
      elastic_value_;  // H that the policy reads: of the iterate; of one with a potential that of the step's first
  MatrixPart elastic_{};
  MatrixPart matrix_{};
  ExecutorSums<RowTotals> totals_;
  bool pattern_changed_ = false;
  bool has_pattern_ = false;  // that of the rows
};

MakeOnExecutor make_contact_on_executor;

}  // namespace bb::exec
