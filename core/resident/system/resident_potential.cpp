// Set-up, the step and its motions. The matrix is in resident_matrix_fill.cpp, what is said of the state in
// resident_report.cpp.
#include "core/resident/system/resident_potential.hpp"

#include <algorithm>

#include "core/math/error.hpp"
#include "core/newton/newton_system.hpp"
#include "core/solvers/linear_solvers.hpp"

namespace bb::resident {
namespace {

/// Of the resident solver, complete. Errors: ConfigError for another one.
ParameterMap linear_parameters(const Method& method) {
  const LinearSolverEntry& entry = linear_solvers().require(method.linear.name, "/linear_solver/name");
  if (entry.matrix != MatrixPlace::executor) {
    throw ConfigError(
        "/linear_solver/name", method.linear.name,
        linear_solver_at(MatrixPlace::executor).name + ": the matrix stays where it is assembled");
  }
  return own_parameters(entry.parameters, method.linear.parameters, "/linear_solver");
}

/// A term that the plan needs and no kernel computes would be left out of E.
void require_kernels(const Plan& plan) {
  for (const TermEntry& entry : term_entries()) {
    if (!plan.term(entry.name).needed || entry.has_kernels()) continue;
    throw ConfigError("/device", std::string(entry.name) + ", a term without kernels",
                      "a scene without it, or device cpu");
  }
}

}  // namespace

ResidentPotential::ResidentPotential(std::unique_ptr<exec::Executor> executor, const Scene& scene,
                                     Method& method, const Plan& plan, const std::vector<std::uint8_t>& fixed,
                                     PhaseClock& clock)
    : IncrementalPotential(clock),
      executor_(std::move(executor)),
      scene_(scene),
      method_(method),
      plan_(plan),
      vectors_(*executor_, fixed, scene.pins),
      elements_(*executor_, scene, method),
      forcing_(linear_parameters(method)),
      max_pcg_iterations_(integer(linear_parameters(method), "max_iterations")),
      elastic_value_(*executor_, "elastic matrix of the iterate"),
      product_partial_(*executor_, "partial products", Partition::most_blocks),
      sum_(*executor_),
      row_totals_(*executor_) {
  require_kernels(plan);
  if (plan.term("contact").needed) {
    contact_ = std::make_unique<ResidentContact>(*executor_, scene, method, plan.contacts, vectors_.fixed());
  }
  pcg_ = std::make_unique<ResidentPcg>(*executor_, scene.n_vertices(),
                                       make_preconditioner(*executor_, linear_parameters(method)));
}

ResidentPotential::~ResidentPotential() = default;

void ResidentPotential::begin_step(const StepColumns& step) {
  has_step_elastic_ = false;
  forcing_.begin_step();
  energies_known_ = trial_evaluated_ = false;
  frame_ = {step.x_n.data(), step.x_tilde.data(), step.dt, step.c, step.load_factor};
  elements_.begin_step(frame_);
  if (contact_) contact_->begin_step(step.x_n, step.dt, step.c);
}

void ResidentPotential::change_step(const StepColumns& step) {
  energies_known_ = false;
  frame_.dt = step.dt;
  frame_.c = step.c;
  elements_.change_frame(frame_);
  if (contact_) contact_->change_time(step.dt, step.c);
}

void ResidentPotential::end_step(const Column&) {
  const ScopedPhase timer(clock(), Phase::stiffness);
  if (contact_) contact_->end_step();
}

// The clusters of a preconditioner go with the pattern that they were made for.
void ResidentPotential::drop_caches() {
  contact_matrix_ = {};
  ++pattern_id_;
}

void ResidentPotential::prepare(const Column& x0, const Column& x1, const Column&, bool) {
  const ScopedPhase timer(clock(), Phase::broad_phase);
  if (contact_) contact_->prepare(x0, x1);
}

double ResidentPotential::bound(const Column& x0, const Column& x1, const Column& dx,
                                IterationReport& report) {
  double smallest = 1;
  holder_.clear();
  if (plan_.term("strain_limit").needed) {
    const ScopedPhase timer(clock(), Phase::strain_bound);
    smallest = report.alpha_strain = elements_.bound(x0.data(), dx.data(), method_.contact_options.ccd_park);
    if (smallest < 1) holder_ = "the strain limit";
  }
  if (contact_) {
    const ScopedPhase timer(clock(), Phase::step_bound);
    report.bound = contact_->bound(x0, x1);
    report.alpha_ccd = report.bound.alpha;
    if (report.bound.alpha < 1 && report.bound.alpha <= smallest) holder_ = contact_->describe_bound();
    smallest = std::min(smallest, report.bound.alpha);
  }
  return smallest;
}

// The values of the matrix may have been given back.
bool ResidentPotential::make_room(const Column& x, const Column& dx, double bound, Column& force) {
  if (!contact_ || !contact_->make_room(x, dx, bound, force)) return false;
  fill(x, level_);
  return true;
}

// Contact sees for itself that a number is not finite.
bool ResidentPotential::admits(const Column& x, Column& trial) {
  trial_evaluated_ = false;
  if (!contact_ && vectors_.first_not_finite(trial) >= 0) return false;
  if (!elements_.admits(trial.data())) return false;
  if (!contact_) return true;
  {
    const ScopedPhase rows(clock(), Phase::contact_rows);
    if (!contact_->admits(x, trial)) return false;
  }
  contact_->freeze(kept_elastic());
  return true;
}

// The limit has been measured at the trial, where the energies of the iterate are known.
EnergyChange ResidentPotential::change(const Column& x, const Column& trial) {
  if (!energies_known_) {
    know_energies(x);
    elements_.admits(trial.data());
  }
  elements_.evaluate(trial.data());
  trial_evaluated_ = true;
  sum_.clear();
  elements_.add_change(x.data(), trial.data(), sum_);
  const Compensated fixed = sum_.get();
  EnergyChange out{fixed.value(), fixed.magnitude};
  if (!contact_) return out;
  contact_->evaluate();
  // rows come and go: their energies are compared as sums
  const auto before = contact_->energy(x), after = contact_->trial_energy(trial);
  const double change = (fixed.sum + (after.sum - before.sum)) + (fixed.carry + (after.carry - before.carry));
  return EnergyChange{change, fixed.magnitude + before.magnitude + after.magnitude};
}

void ResidentPotential::accept() {
  if (trial_evaluated_) elements_.accept();
  if (contact_) contact_->accept();
  energies_known_ = trial_evaluated_;
  trial_evaluated_ = false;
}

// As on the host: a step that compares no energies ends with a state that has none.
void ResidentPotential::know_energies(const Column& x) {
  if (energies_known_) return;
  const WholePhase timer(clock(), Phase::output);
  elements_.admits(x.data());
  elements_.evaluate(x.data());
  elements_.accept();
  energies_known_ = true;
}

void ResidentPotential::expect(const ExpectedContacts& expected) {
  if (contact_) contact_->expect(expected);
}

void count_memory(NewtonSystem& system, ResidentPotential& potential, const Scene& scene,
                  const ExpectedContacts& expected) {
  potential.expect(expected);
  system.begin_step(scene.x0, {1, scene.x0}, 1, 1);
  for (int iterate = 0; iterate < 2; ++iterate) {  // the second finds the columns of the first in place
    system.assemble();
    system.find_direction();
    system.check_end();
    system.prepare_motion(MotionEnd::free, false);
    IterationReport unread;
    system.bound_motion(unread);
    system.try_motion(1);
    system.accept();
  }
  system.end_step();
}

}  // namespace bb::resident
