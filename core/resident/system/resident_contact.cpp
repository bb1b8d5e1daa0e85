#include "core/resident/system/resident_contact.hpp"

#include <algorithm>

#include "core/contact/pair_name.hpp"
#include "core/math/error.hpp"
#include "core/resident/contact/detour_kernels.hpp"

namespace bb::resident {

ResidentContact::ResidentContact(exec::Executor& executor, const Scene& scene, TermOptions& options,
                                 const ContactPlan& plan, const exec::Buffer<std::uint8_t>& fixed)
    : executor_(executor),
      scene_(scene),
      options_(options),
      fixed_(fixed),
      surface_(scene),
      resident_surface_(executor, scene, surface_),
      candidates_(executor),
      broad_phase_(executor, resident_surface_, surface_, plan),
      step_bound_(executor, resident_surface_,
                  {options.contact_options.ccd_park, options.contact_options.ccd_max_probes}),
      finder_(executor, resident_surface_, plan.mollifier.needed),
      stiffness_(executor, *options.stiffness, scene.mass),
      barrier_(options.contact, options.stiffness->has_potential()),
      assembly_(executor, resident_surface_, scene.n_vertices()),
      sums_(executor),
      curved_(executor),
      straight_(executor),
      gaps_(executor),
      rows_(executor, columns_of(*options.stiffness)),
      trial_(executor, columns_of(*options.stiffness)),
      part_(executor, "contact gradient"),
      mass_(executor, "contact masses") {
  mass_.upload(scene.mass);
}

void ResidentContact::expect(const ExpectedContacts& expected) {
  broad_phase_.expect(expected.candidates);
  finder_.expect(expected);
  assembly_.expect(expected);
}

void ResidentContact::begin_step(const Column& x_n, double dt, double c) {
  stiffness_.begin_step();
  change_time(dt, c);
  first_iterate_ = true;
  if (frugal()) assembly_.free_matrix();
  listed_ = false;
  find_rows(x_n);
  take_trial();
  evaluated_ = true;  // as far as rows without kappa can be
}

void ResidentContact::take_trial() {
  has_pattern_ = has_pattern_ && finder_.same_stencils(rows_, trial_);
  rows_.swap(trial_);
  evaluated_ = trial_evaluated_;
  lent_ = false;
  energy_.reset();
}

void ResidentContact::prepare(const Column& x0, const Column& x1) {
  if (frugal()) assembly_.free_matrix();
  const std::size_t lists =
      broad_phase_.count(x0, x1).bytes();  // takes memory, so before what is left is asked
  listed_ = lists <= list_budget();
  in_trees_ = !listed_;
  if (listed_) {
    fill_lists();
  } else {
    candidates_.free();
  }
}

// Of a memory that is limited the lists may have half of what there is: sorting them takes as much again.
std::size_t ResidentContact::list_budget() const {
  return std::min(list_budget_, executor_.memory().left() / 2 + candidates_.bytes() / 2);
}

// Of what was counted last.
void ResidentContact::fill_lists() {
  broad_phase_.keep_room(!frugal());
  broad_phase_.fill(candidates_);
  if (!frugal()) return;
  broad_phase_.free();
  executor_.trim();
}

// Rows of a state of the motion, in the trial's table.
void ResidentContact::find_rows(const Column& x) {
  lend_columns();
  if (!listed_) {
    in_trees_ = false;
    broad_phase_.count(x, x);
    fill_lists();
  }
  finder_.find(x, candidates_, trial_);
  trial_evaluated_ = false;
}

void ResidentContact::lend_columns() {
  if (!lent_) rows_.lend(trial_);
  lent_ = true;
}

// No trial was accepted: the shared columns are those of another state.
void ResidentContact::take_back(const Column& x) {
  if (!lent_) return;
  find_rows(x);
  trial_.lend(rows_);
  lent_ = evaluated_ = false;
}

void ResidentContact::settle(const Column& x) {
  take_back(x);
  if (!evaluated_) barrier_.evaluate(executor_, rows_);
  evaluated_ = true;
}

Compensated ResidentContact::energy(const Column& x) {
  if (!energy_) {
    settle(x);
    energy_ = sums_.energy(rows_, x, assembly_);
  }
  return *energy_;
}

void ResidentContact::change_time(double dt, double c) {
  time_ = {dt, c};
  stiffness_.set_time(time_);
}

void ResidentContact::use_policy_kappa() {
  if (options_.stiffness->uniform()) stiffness_.set_uniform(options_.stiffness->state().kappa);
}

void ResidentContact::linearise(const Column& x, const MatrixPart& elastic, Column& g) {
  take_back(x);
  energy_.reset();
  if (frugal()) give_back_motion();
  pattern_changed_ = !has_pattern_;
  if (!has_pattern_) assembly_.set_pattern(rows_);
  if (frugal()) executor_.trim();
  has_pattern_ = true;
  start_policy(x, g);
  use_policy_kappa();
  const double change = stiffness_.refresh(rows_, elastic);
  kappa_change_ = first_iterate_ ? 0 : change;
  first_iterate_ = false;
  barrier_.evaluate(executor_, rows_);
  evaluated_ = true;
  assembly_.add_gradient(rows_, x, g);
}

void ResidentContact::give_back_motion() {
  candidates_.free(), trial_.free(), finder_.free(), broad_phase_.free();
  executor_.trim();
}

void ResidentContact::start_policy(const Column& x, const Column& others) {
  StiffnessPolicy& policy = *options_.stiffness;
  if (!policy_start_.due(policy, static_cast<std::size_t>(rows_.size()))) return;
  stiffness_.set_uniform(1);
  stiffness_.refresh(rows_, {});
  barrier_.evaluate(executor_, rows_);
  part_.resize(others.size());
  part_.fill_zero();
  assembly_.add_gradient(rows_, x, part_);
  const StartSums sums{sums_.product(part_, others, fixed_), sums_.product(part_, part_, fixed_),
                       sums_.mean_mass(rows_, mass_)};
  if (executor_.counts_only()) return policy_start_.set_started(true);
  policy_start_.start(policy, scene_, options_.contact, sums, time_);
}

const StepBound& ResidentContact::bound(const Column& x0, const Column& x1) {
  if (listed_) {
    bound_ = step_bound_.find(candidates_, x0, x1);
    return bound_;
  }
  if (!in_trees_) broad_phase_.count(x0, x1);  // a state was looked at since
  in_trees_ = true;
  bound_ = step_bound_.find_without_list(broad_phase_.source(), x0, x1);
  return bound_;
}

// The barrier of the rows is lost meanwhile.
bool ResidentContact::make_room(const Column& x, const Column& dx, double bound, Column& force) {
  settle(x);
  curved_.clear(), straight_.clear();
  force.fill_zero();
  executor_.each(rows_.size(), DetourRows{rows_.view(), resident_surface_.view(), x.data(), dx.data(),
                                          curved_.data(), straight_.data()});
  const bool held = HoldTimes{curved_.smallest(), straight_.smallest()}.by_curvature(bound);
  if (held) assembly_.add_gradient(rows_, x, force);
  barrier_.evaluate(executor_, rows_);
  if (held && frugal()) {
    give_back_motion();
    listed_ = in_trees_ = false;
  }
  return held;
}

std::string ResidentContact::describe_bound() const { return pair_name(scene_, bound_.key, bound_.kind); }

bool ResidentContact::admits(const Column& x, const Column& trial) {
  energy(x);  // while its rows have all columns
  find_rows(trial);
  return trial_.feasible();
}

void ResidentContact::freeze(const MatrixPart& elastic) {
  use_policy_kappa();
  stiffness_.freeze(trial_, rows_, elastic);
}

void ResidentContact::evaluate() {
  barrier_.evaluate(executor_, trial_);
  trial_evaluated_ = true;
}

void ResidentContact::accept() {
  take_trial();
  stiffness_.keep(rows_);
}

void ResidentContact::end_step() {
  StiffnessPolicy& policy = *options_.stiffness;
  if (!policy.adapts()) return;
  policy.end_step(gaps_.end_step(rows_, options_.contact_options.ccd_park));
}

}  // namespace bb::resident
