// A step and its motions. Matrix and direction are in newton_direction.cpp.
#include "core/newton/newton_system.hpp"

#include <stdexcept>

#include "core/base/archive/archive.hpp"
#include "core/newton/host_engine.hpp"
#include "core/terms/known_step.hpp"

namespace bb {
namespace {

std::unique_ptr<IncrementalPotential> make_host_engine(const Scene& scene, Method& method, const Plan& plan,
                                                       const std::vector<std::uint8_t>& fixed,
                                                       PhaseClock& clock) {
  return std::make_unique<HostEngine>(scene, method, plan, fixed, clock);
}

std::span<const double> numbers_of(const Positions& x) {
  return {x.data(), static_cast<std::size_t>(x.size())};
}

Positions copy_of(const Column& column) {
  Positions out(3, column.size() / 3);
  column.download({out.data(), static_cast<std::size_t>(out.size())});
  return out;
}

}  // namespace

NewtonSystem::NewtonSystem(const Scene& scene, Method& method, const Plan& plan, const MakePotential& make)
    : method_(method),
      state_(scene, method, plan, clock(), make),
      view_(*this, state_),
      exact_hessians_(exact_hessians(state_.plan, method)) {}

NewtonSystem::NewtonSystem(const Scene& scene, Method& method, const Plan& plan)
    : NewtonSystem(scene, method, plan, method.make_potential ? method.make_potential : make_host_engine) {}

NewtonSystem::NewtonSystem(const Scene& scene, Method& method)
    : NewtonSystem(scene, method, make_plan(scene, method, plan_options(method))) {}

NewtonSystem::~NewtonSystem() = default;

StepColumns NewtonSystem::step_columns() const {
  return {state_.x_n, state_.x_tilde, dt_, c_, load_factor_, t_end_, at_start_};
}

void NewtonSystem::begin_step(const Positions& x_n, const Prediction& prediction, double dt,
                              double load_factor) {
  const ScopedPhase timer(clock(), Phase::prediction);
  state_.x_n.upload(numbers_of(x_n));
  state_.x.upload(numbers_of(x_n));
  state_.x_tilde.upload(numbers_of(prediction.x_tilde));
  view_.forget();
  state_.pins_seen = state_.direction_seen = state_.secant_asked = false;
  dt_ = dt;
  c_ = prediction.c;
  t_end_ = prediction.t_end;
  at_start_ = prediction.at_start;
  load_factor_ = load_factor;
  state_.level.reset();
  served_at_once_ = false;
  state_.potential->begin_step(step_columns());
}

void NewtonSystem::restart_step(const Prediction& prediction, double dt) {
  const ScopedPhase timer(clock(), Phase::prediction);
  state_.x_tilde.upload(numbers_of(prediction.x_tilde));
  dt_ = dt;
  c_ = prediction.c;
  t_end_ = prediction.t_end;
  state_.potential->change_step(step_columns());
}

void NewtonSystem::end_step() { state_.potential->end_step(state_.x); }

void NewtonSystem::set_target(const Positions& target) {
  target_ = target;
  state_.pins_seen = false;
  state_.vectors.set_targets(target);
}

void NewtonSystem::prepare_motion(MotionEnd end, bool to_bound) {
  end_ = end;
  move(1, state_.end);
  state_.potential->prepare(state_.x, state_.end, state_.dx, to_bound);
}

// x + alpha dx; prescribed vertices exactly on target at the end of a motion that leads there.
void NewtonSystem::move(double alpha, Column& to) {
  if (end_ == MotionEnd::on_target && alpha == 1) {
    state_.vectors.move_to_targets(state_.x, state_.dx, to);
  } else {
    state_.vectors.move(state_.x, state_.dx, alpha, to);
  }
}

double NewtonSystem::bound_motion(IterationReport& report) {
  return state_.potential->bound(state_.x, state_.end, state_.dx, report);
}

// Prescribed vertices that are held back do not reach their targets.
std::optional<TruncatedMotion> NewtonSystem::truncate_motion(IterationReport& report) {
  if (!state_.potential->bounds_each_vertex()) return std::nullopt;
  state_.aside.copy_from(state_.dx);
  state_.direction_seen = false;
  const double of_pins = state_.potential->truncate(state_.dx);
  if (of_pins < 1) end_ = MotionEnd::free;
  move(1, state_.end);
  return TruncatedMotion{state_.potential->bound_truncated(state_.x, state_.end, state_.dx, report), of_pins};
}

bool NewtonSystem::try_feasible(double alpha) {
  const ScopedPhase timer(clock(), Phase::line_search);
  move(alpha, state_.trial);
  state_.trial_pins_seen = false;
  return state_.potential->is_feasible(state_.x, state_.trial);
}

std::optional<EnergyChange> NewtonSystem::try_motion(double alpha) {
  if (!try_feasible(alpha)) return std::nullopt;
  const ScopedPhase timer(clock(), Phase::line_search);
  state_.look_at_trial_pins();
  return state_.potential->change(state_.x, state_.trial);
}

void NewtonSystem::accept() {
  state_.x.swap(state_.trial);
  state_.pins_seen = state_.trial_pins_seen;
  state_.direction_seen = false;
  view_.forget();
  state_.potential->accept();
}

void NewtonSystem::set_direction(const Positions& dx) {
  state_.dx.upload(numbers_of(dx));
  state_.direction_seen = false;
}

void NewtonSystem::go_to(const Positions& x) {
  set_direction(x - view_.x());
  state_.end.upload(numbers_of(x));
  state_.potential->prepare(state_.x, state_.end, state_.dx, false);
  state_.trial.upload(numbers_of(x));
  state_.trial_pins_seen = false;
  if (!state_.potential->is_feasible(state_.x, state_.trial)) {
    throw std::logic_error("a state that is gone to is not feasible");
  }
  accept();
}

// What is frozen for a step is frozen at its start: that state is assembled first.
void NewtonSystem::mirror(const Positions& target, const NewtonState& of, const Positions& x) {
  if (x != view_.x()) {
    assemble();
    go_to(x);
  }
  state_.level = of.level;
  state_.secant_asked = of.secant;  // its share came with the rows of the terms
  assemble();
  set_target(target);
  set_right_hand_side();
}

void NewtonSystem::adopt(const StepFrame& frame, NewtonSystem& other) {
  begin_step(frame.x_n, {frame.c, frame.x_tilde, frame.t_end}, frame.dt, frame.load_factor);
  dynamic_cast<HostEngine&>(potential()).adopt(dynamic_cast<const HostEngine&>(other.potential()));
  const Positions x = other.view_.x();
  mirror(x, other.state_, x);
}

bool NewtonSystem::is_on_host() const {
  return dynamic_cast<const HostEngine*>(state_.potential.get()) != nullptr;
}

NewtonSystem& NewtonSystem::on_host() {
  if (is_on_host()) return *this;
  if (!host_) host_.reset(new NewtonSystem(state_.scene, method_, state_.plan, make_host_engine));
  Archive memory;
  keep(memory);
  Archive again(memory.bytes());
  host_->keep(again);
  host_->begin_step(copy_of(state_.x_n), {c_, copy_of(state_.x_tilde), t_end_}, dt_, load_factor_);
  dynamic_cast<HostEngine&>(host_->potential()).adopt(state_.potential->known_step());
  host_->mirror(target_, state_, view_.x());
  host_->set_direction(copy_of(state_.dx));
  return *host_;
}

HostEngine& NewtonSystem::host_engine() {
  auto* potential = dynamic_cast<HostEngine*>(state_.potential.get());
  if (!potential) throw std::logic_error("terms and matrices are read on the host: on_host()");
  return *potential;
}

Diagnosis& NewtonSystem::diagnosis() {
  if (!diagnosis_) diagnosis_ = std::make_unique<Diagnosis>(host_engine(), state_);
  return *diagnosis_;
}

ConstraintSystem& NewtonSystem::constraints() {
  if (!constraints_) constraints_ = std::make_unique<ConstraintSystem>(host_engine(), state_, method_);
  return *constraints_;
}

}  // namespace bb
