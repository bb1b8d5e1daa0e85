// The contact term in an executor's memory: what ContactTerm does on the CPU, row by row and pair by pair.
#pragma once

#include <memory>
#include <optional>

#include "core/contact/step_bound.hpp"
#include "core/record/phase_times.hpp"
#include "core/resident/contact/contact_assembly.hpp"
#include "core/resident/contact/contact_sums.hpp"
#include "core/resident/contact/resident_barrier.hpp"
#include "core/resident/contact/resident_broad_phase.hpp"
#include "core/resident/contact/resident_step_bound.hpp"
#include "core/resident/contact/resident_stiffness.hpp"
#include "core/resident/contact/row_finder.hpp"
#include "core/terms/policy_start.hpp"
#include "core/terms/report.hpp"
#include "core/terms/term_options.hpp"

namespace bb::resident {

class ResidentContact {
 public:
  using Column = exec::Buffer<double>;

  /// scene and options must outlive it. fixed: three bits a vertex. Errors: ConfigError for a shape or a policy without
  /// a device form; OutOfMemory.
  ResidentContact(exec::Executor& executor, const Scene& scene, TermOptions& options, const ContactPlan& plan,
                  const exec::Buffer<std::uint8_t>& fixed);

  /// What an executor that only counts buffers is to take the contacts for.
  void expect(const ExpectedContacts& expected);

  // --- a step
  void begin_step(const Column& x_n, double dt, double c);
  void change_time(double dt, double c);
  /// Tells a policy that adapts which pairs had a row at two step ends in a row.
  void end_step();

  // --- an iterate. elastic: the clamped elastic matrix, read where needs_hessian()
  bool needs_hessian() const { return options_.stiffness->needs_hessian(); }
  /// kappa and barrier of the rows at x; g (N) is the gradient of all other terms and gets that of B.
  void linearise(const Column& x, const MatrixPart& elastic, Column& g);
  /// Valid until the next call, or the next prepare().
  MatrixPart matrix(const Column& x, const HessianChoice& choice) {
    settle(x);
    return assembly_.matrix(rows_, x, choice);
  }
  Index n_blocks() const { return assembly_.n_blocks(); }
  /// Whether the last linearise() built another pattern.
  bool pattern_changed() const { return pattern_changed_; }
  /// force (N) += how the gradient changes along motion of given vertices.
  void add_given_motion(const Column& x, const Column& motion, Column& force) {
    settle(x);
    assembly_.add_given_motion(rows_, x, motion, force);
  }
  /// Of the rows of the iterate, as linearise() or accept() left them.
  Compensated energy(const Column& x);

  // --- a motion, and states on it
  void prepare(const Column& x0, const Column& x1);
  const StepBound& bound(const Column& x0, const Column& x1);
  /// force [3 n_vertices] (N) becomes what makes room for gaps that are curved along dx; whether they hold a motion that
  /// bound() ends at `bound`. Where it is frugal the lists of the motion are gone after that.
  bool make_room(const Column& x, const Column& dx, double bound, Column& force);
  std::string describe_bound() const;
  /// x: the iterate.
  bool admits(const Column& x, const Column& trial);
  /// kappa of the trial, after admits().
  void freeze(const MatrixPart& elastic);
  /// Its barrier, after freeze(), where its energy is asked for.
  void evaluate();
  Compensated trial_energy(const Column& trial) { return sums_.energy(trial_, trial, assembly_); }
  /// The trial becomes the iterate.
  void accept();

  /// Of the iterate x.
  ResidentRows& rows(const Column& x) {
    settle(x);
    return rows_;
  }
  /// From so many rows on, what a stage does not read is given back before it: candidates and trial rows before a
  /// solve, matrix values before a motion. Results do not depend on it.
  void set_frugal_from(Index rows) { frugal_from_ = rows; }
  bool frugal() const { return rows_.size() >= frugal_from_; }
  /// Bytes that the candidate lists of a motion may take. A motion that needs more has none: its bound is found in the
  /// trees, and every state on it gets its own lists. Results do not depend on it; counters of the bound do.
  void set_list_budget(std::size_t bytes) { list_budget_ = bytes; }
  const ResidentStiffness& stiffness() const { return stiffness_; }
  const StiffnessPolicy& policy() const { return *options_.stiffness; }
  /// Of the last linearise(): largest relative change of a row's kappa.
  double kappa_change() const { return kappa_change_; }
  PolicyStart& policy_start() { return policy_start_; }
  StepEndGaps& step_end_gaps() { return gaps_; }

 private:
  static constexpr Index default_frugal_from = Index{1} << 24;
  /// Twice the lists of 184 million contacts with two candidates each: more come of a motion that sweeps far, not of
  /// contacts.
  static constexpr std::size_t default_list_budget = std::size_t{8} << 30;
  std::size_t list_budget() const;
  void fill_lists();
  void find_rows(const Column& x);
  void lend_columns();
  void settle(const Column& x);
  void take_back(const Column& x);
  void take_trial();
  void start_policy(const Column& x, const Column& others);
  void use_policy_kappa();
  void give_back_motion();

  exec::Executor& executor_;
  const Scene& scene_;
  TermOptions& options_;
  const exec::Buffer<std::uint8_t>& fixed_;
  Surface surface_;
  ResidentSurface resident_surface_;
  ResidentCandidates candidates_;
  ResidentBroadPhase broad_phase_;
  ResidentStepBound step_bound_;
  RowFinder finder_;
  ResidentStiffness stiffness_;
  ResidentBarrier barrier_;
  ContactAssembly assembly_;
  ContactSums sums_;
  ResidentLeast curved_, straight_;  // HoldTimes
  StepEndGaps gaps_;
  ResidentRows rows_, trial_;
  bool lent_ = false;                                // the trial has the columns that the two share
  bool evaluated_ = true, trial_evaluated_ = false;  // the rows have a barrier; those of the trial
  std::optional<Compensated> energy_;
  Index frugal_from_ = default_frugal_from;
  std::size_t list_budget_ = default_list_budget;
  bool listed_ = false;    // the candidate lists are those of the motion
  bool in_trees_ = false;  // the trees are those of the motion, which has no lists
  Column part_;            // [3 n] gradient of B with kappa = 1
  exec::Buffer<double> mass_;
  StepBound bound_;
  StiffnessTime time_;
  PolicyStart policy_start_;
  double kappa_change_ = 0;
  bool first_iterate_ = true, pattern_changed_ = false;
  bool has_pattern_ = false;  // that of the rows
};

}  // namespace bb::resident
