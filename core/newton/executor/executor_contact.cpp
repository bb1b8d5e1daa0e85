#include "core/newton/executor/executor_contact.hpp"

#include <algorithm>

#include "core/contact/executor/curvature_correction_kernels.hpp"

namespace bb::exec {

ExecutorContact::ExecutorContact(const ExecutorInputs& inputs)
    : ContactSteps(inputs.scene, inputs.options),
      executor_(inputs.executor),
      vectors_(inputs.vectors),
      mass_(inputs.mass),
      surface_(scene_, options_.contact_options.rest_rule),
      executor_surface_(executor_, scene_, surface_),
      candidates_(executor_),
      broad_phase_(executor_, executor_surface_, surface_, inputs.contacts),
      step_bound_(executor_, executor_surface_,
                  {options_.contact_options.min_gap_fraction, options_.contact_options.ccd_max_probes}),
      finder_(executor_, executor_surface_, inputs.contacts.mollifier.needed),
      stiffness_(executor_, *options_.stiffness),
      barrier_(options_.contact, options_.stiffness->has_potential(),
               executor_.in_host_memory() || executor_.counts_only()),
      assembly_(executor_, executor_surface_, scene_.n_vertices()),
      sums_(executor_),
      curved_(executor_),
      straight_(executor_),
      rows_(executor_, columns_of(*options_.stiffness)),
      trial_(executor_, columns_of(*options_.stiffness)),
      part_(executor_, "contact gradient"),
      elastic_value_(executor_, "elastic matrix of the iterate"),
      totals_(executor_) {}

void ExecutorContact::expect(const ExpectedContacts& expected) {
  broad_phase_.expect(expected.candidates);
  finder_.expect(expected);
  assembly_.expect(expected);
}

void ExecutorContact::begin_step(const StepColumns& step, PhaseClock&) {
  stiffness_.begin_step();
  change_step(step);
  if (frugal()) assembly_.free_matrix();
  listed_ = false;
  find_rows(step.x_n);
  take_trial();
  evaluated_ = true;  // the barrier is evaluated; kappa is not set yet
}

void ExecutorContact::take_trial() {
  if (has_pattern_ && !compared_) finder_.compare(rows_, trial_);
  has_pattern_ = has_pattern_ && finder_.same();
  compared_ = false;
  rows_.swap(trial_);
  evaluated_ = taken_ = trial_evaluated_;
  lent_ = false;
  looked_ = false;
}

void ExecutorContact::prepare(const Motion& motion, PhaseClock& clock) {
  const ScopedPhase timer(clock, Phase::broad_phase);
  if (frugal()) assembly_.free_matrix();
  const std::size_t lists = count_candidates(motion.x0, motion.x1, list_budget());
  listed_ = lists <= list_budget();  // read again: counting took memory
  in_trees_ = !listed_;
  if (listed_) {
    fill_lists();
  } else {
    candidates_.free();
  }
}

// Of a memory that is limited the lists may have half of what there is: sorting them takes as much again.
std::size_t ExecutorContact::list_budget() const {
  return std::min(list_budget_, executor_.memory().left() / 2 + candidates_.bytes() / 2);
}

// Bytes of the lists; those that are there already are filled on the way, and may take `most`.
std::size_t ExecutorContact::count_candidates(const PositionsView& x0, const PositionsView& x1,
                                              std::size_t most) {
  broad_phase_.keep_room(!frugal());
  return broad_phase_.count(x0, x1, candidates_, most).bytes();
}

// Of what was counted last.
void ExecutorContact::fill_lists() {
  broad_phase_.fill(candidates_);
  if (!frugal()) return;
  broad_phase_.free();
  executor_.trim();
}

// Rows of a state of the motion, in the trial's table: look_for_rows(), then finder_.finish().
void ExecutorContact::look_for_rows(const PositionsView& x) {
  lend_columns();
  if (!listed_) {
    in_trees_ = false;
    count_candidates(x, x, 0);
    fill_lists();
  }
  finder_.look(x, candidates_);
  trial_evaluated_ = compared_ = false;
}

void ExecutorContact::find_rows(const PositionsView& x) {
  look_for_rows(x);
  finder_.finish(trial_);
}

void ExecutorContact::lend_columns() {
  if (!lent_) rows_.lend(trial_);
  lent_ = true;
}

// No trial was accepted: the shared columns are those of another state.
void ExecutorContact::take_back(const PositionsView& x) {
  if (!lent_) return;
  find_rows(x);
  trial_.lend(rows_);
  lent_ = evaluated_ = false;
}

void ExecutorContact::settle(const PositionsView& x) {
  take_back(x);
  if (!evaluated_) barrier_.evaluate(executor_, rows_);
  evaluated_ = true;
}

void ExecutorContact::look_at_rows(const PositionsView& x) {
  if (looked_) return;
  settle(x);
  const RowEnergy energy = assembly_.row_energy(rows_, x);
  totals_.clear();
  totals_.add(rows_.size(), TotalsOfRows{rows_.view(), energy});
  looked_ = true;
}

// What the policy reads of the matrix now, or has read at the step's first iterate.
void ExecutorContact::keep_elastic(const ExecutorContext& context) {
  elastic_ = context.elastic;
  if (!options_.stiffness->needs_hessian()) return;
  if (stiffness_.takes_matrix()) {
    elastic_value_.resize(value_count(context.n_blocks));
    executor_.copy(elastic_value_.data(), elastic_.value,
                   static_cast<std::size_t>(elastic_value_.size()) * sizeof(double));
  }
  elastic_.value = elastic_value_.data();
}

void ExecutorContact::refresh_kappa() {
  rows_.uniform_kappa = policy_kappa();
  const StiffnessRows of[] = {rows_.stiffness_rows()};
  const KernelKappa kappa = kappa_of(rows_);
  stiffness_.refresh(of, std::cref(kappa));
}

void ExecutorContact::linearise(const PositionsView& x, const ExecutorContext& context, PositionsSpan g) {
  keep_elastic(context);
  take_back(x);
  looked_ = false;
  if (frugal()) give_back_motion();
  pattern_changed_ = !has_pattern_;
  if (!has_pattern_) assembly_.set_pattern(rows_);
  if (frugal()) executor_.trim();
  has_pattern_ = true;
  start_policy(x, g, static_cast<std::size_t>(rows_.size()));
  const bool same = taken_ && evaluated_ && options_.stiffness->uniform() &&
                    rows_.uniform_kappa == policy_kappa();  // as in the trial that was accepted
  refresh_kappa();
  if (!same) barrier_.evaluate(executor_, rows_);
  evaluated_ = true;
  taken_ = false;
  assembly_.add_gradient(rows_, x, g);
  look_at_rows(x);
}

void ExecutorContact::add_matrix(const PositionsView& x, const HessianRequest& request) {
  settle(x);
  const bool blended = request.t > 0;
  matrix_ = assembly_.matrix(rows_, x,
                             {options_.hessian_mode, request.first, blended, blended ? request.t : 1,
                              request.threshold, request.force});
}

void ExecutorContact::give_back_motion() {
  candidates_.free(), trial_.free(), finder_.free(), broad_phase_.free();
  executor_.trim();
}

std::optional<StartSums> ExecutorContact::start_sums(const PositionsView& x, const PositionsView& others) {
  rows_.uniform_kappa = 1;
  barrier_.evaluate(executor_, rows_);
  evaluated_ = false;  // with another kappa
  part_.resize(others.size());
  part_.fill_zero();
  assembly_.add_gradient(rows_, x, part_);
  const StartSums sums{sums_.product(part_, others, vectors_.fixed()),
                       sums_.product(part_, part_, vectors_.fixed()), sums_.mean_mass(rows_, mass_)};
  if (executor_.counts_only()) return {};
  return sums;
}

void ExecutorContact::look_along(const Motion& motion, PhaseClock& clock) {
  const ScopedPhase timer(clock, Phase::step_bound);
  if (listed_) return step_bound_.look(candidates_, motion.x0, motion.x1);
  if (!in_trees_) broad_phase_.fit(motion.x0, motion.x1);  // a state was looked at since
  in_trees_ = true;
}

StepBound ExecutorContact::find_bound(const Motion& motion) {
  return listed_ ? step_bound_.finish()
                 : step_bound_.find_without_list(broad_phase_.source(), motion.x0, motion.x1);
}

// The barrier of the rows is lost meanwhile.
bool ExecutorContact::add_curvature_correction(const PositionsView& x, const PositionsView& dx, double bound,
                                               PositionsSpan force) {
  settle(x);
  curved_.clear(), straight_.clear();
  executor_.each(rows_.size(), CurvatureCorrectionRows{rows_.view(), executor_surface_.view(), x.data(),
                                                       dx.data(), curved_.data(), straight_.data()});
  const bool held = HoldTimes{curved_.smallest(), straight_.smallest()}.by_curvature(bound);
  if (held) assembly_.add_gradient(rows_, x, force);
  barrier_.evaluate(executor_, rows_);
  if (held && frugal()) {
    give_back_motion();
    listed_ = in_trees_ = false;
  }
  return held;
}

void ExecutorContact::look_at(const PositionsView& x, const PositionsView& trial, PhaseClock& clock) {
  const ScopedPhase timer(clock, Phase::contact_rows);
  if (!lent_) look_at_rows(x);  // while its rows have all columns
  look_for_rows(trial);
}

bool ExecutorContact::is_feasible(const PositionsView&, PhaseClock& clock) {
  const ScopedPhase timer(clock, Phase::contact_rows);
  finder_.finish(trial_);
  return trial_.feasible();
}

void ExecutorContact::freeze(PhaseClock& clock) {
  const ScopedPhase timer(clock, Phase::stiffness);
  trial_.uniform_kappa = policy_kappa();
  const StiffnessRows trial[] = {trial_.stiffness_rows()}, iterate[] = {rows_.stiffness_rows()};
  const KernelKappa kappa = kappa_of(trial_);
  stiffness_.freeze(trial, iterate, std::cref(kappa));
}

void ExecutorContact::evaluate(const PositionsView&) {
  barrier_.evaluate(executor_, trial_);
  trial_evaluated_ = true;
}

// Where the trial is accepted its stencils are compared with those of the iterate, so that is launched here.
void ExecutorContact::add_change(const PositionsView& x, const PositionsView& trial, ExecutorChange&) {
  look_at_rows(x);
  sums_.look_at_energy(trial_, trial, assembly_);
  if (has_pattern_) finder_.compare(rows_, trial_);
  compared_ = has_pattern_;
}

void ExecutorContact::add_rows(RowEnergies& out) {
  out.before = out.before + totals_.get().energy;
  out.after = out.after + sums_.energy();
}

void ExecutorContact::accept(PhaseClock& clock) {
  take_trial();
  const ScopedPhase timer(clock, Phase::stiffness);
  const StiffnessRows of[] = {rows_.stiffness_rows()};
  stiffness_.keep(of);
}

void ExecutorContact::end_step(const PositionsView& x, PhaseClock& clock) {
  if (!executor_.counts_only()) ContactSteps::end_step(x, clock);
}

void make_contact_on_executor(const ExecutorInputs& inputs, ExecutorTerms& terms) {
  terms.add(std::make_unique<ExecutorContact>(inputs));
}

}  // namespace bb::exec
