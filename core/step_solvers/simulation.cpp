#include "core/step_solvers/simulation.hpp"

#include <algorithm>
#include <stdexcept>

#include "core/base/archive/archive.hpp"
#include "core/newton/iteration.hpp"
#include "core/step_solvers/registry.hpp"
#include "core/step_solvers/velocity_damping.hpp"

namespace bb {

namespace {

/// Charges an observer's time to Phase::output.
class ChargedObserver final : public StepObserver {
 public:
  ChargedObserver(StepObserver& observer, PhaseClock& clock) : observer_(observer), clock_(clock) {}
  void on_matrix(StepSystem& system, int step, int iteration) override {
    const ScopedPhase timer(clock_, Phase::output);
    observer_.on_matrix(system, step, iteration);
  }
  void on_iteration(const IterationReport& report) override {
    const ScopedPhase timer(clock_, Phase::output);
    observer_.on_iteration(report);
  }
  bool watches_motions() const override { return observer_.watches_motions(); }
  void on_motion(const Positions& x0, const Positions& x1, int step) override {
    const ScopedPhase timer(clock_, Phase::output);
    observer_.on_motion(x0, x1, step);
  }
  void on_retry(int step) override {
    const ScopedPhase timer(clock_, Phase::output);
    observer_.on_retry(step);
  }
  void on_redo(int step) override {
    const ScopedPhase timer(clock_, Phase::output);
    observer_.on_redo(step);
  }
  void on_step(StepSystem& system, const StepReport& report, const Positions& x) override {
    const ScopedPhase timer(clock_, Phase::output);
    observer_.on_step(system, report, x);
  }

 private:
  StepObserver& observer_;
  PhaseClock& clock_;
};

/// All of the counters have a number, and nothing else has.
bool declared(const std::vector<SolverCounter>& counters, const SolverCounts& counts) {
  return counts.values.size() == counters.size() &&
         std::all_of(counters.begin(), counters.end(),
                     [&counts](const SolverCounter& each) { return counts.values.contains(each.name); });
}

}  // namespace

Simulation::Simulation(const Scene& scene, Method& method, double dt, int n_steps)
    : Simulation(scene, method, make_plan(scene, method, plan_options(method)), dt, n_steps) {}

Simulation::Simulation(const Scene& scene, Method& method, const Plan& plan, double dt, int n_steps)
    : scene_(scene),
      held_(scene, dt / 2),
      method_(method),
      plan_(plan),
      dt_(dt),
      n_steps_(n_steps),
      size_(method.step_size),
      parts_(method.step_solver.retries + size_.most_halvings()),
      entry_(step_solvers().require(method.step_solver.name, "/step_solver/name")),
      proves_steps_(scene.collisions.has(CollisionKind::audited)),
      solver_(make_step_solver(method.step_solver)) {
  if (method.step_needs != entry_.needs) {
    throw std::logic_error("the method has step_needs of another step solver than " + entry_.name);
  }
  if (entry_.settings.unmoved) require_unmoved(scene, entry_.name);
  if (entry_.settings.own_stiffness) require_unbreakable(scene, entry_.name);
  if (proves_steps_ && !bounds_motions(method.step_solver)) {
    throw ConfigError("/scene/collisions", "a pair that collides as audited",
                      "none: the step solver " + entry_.name + " bounds no motion");
  }
  make_system();
  history_.x = scene.x0;
  round_state(method.precision, history_.x);
  history_.v = scene.v0;
  history_.a.setZero(3, scene.x0.cols());
  history_.x_prev = history_.x;
  history_.v_prev = history_.v;
}

void Simulation::make_system() {
  system_ = std::make_unique<NewtonSystem>(held_.now(), method_, plan_);
  if (!entry_.asked_to_converge && entry_.needs.matrix) {
    end_residual_ = std::make_unique<EndResidual>(held_.now(), method_, plan_);
  }
  solver_->require(*system_);
}

// Degrees of freedom, masses and surfaces that can move are those of a system: another one takes over what the terms remember,
// as a run does that goes on elsewhere. Whether there is another one.
bool Simulation::hold_pins(std::vector<int> holding) {
  if (holding == held_.holding()) return false;
  Archive memory;
  system_->keep(memory);
  end_residual_.reset();
  system_.reset();
  held_.hold(std::move(holding));
  make_system();
  Archive again(memory.bytes());
  system_->keep(again);
  return true;
}

// Whether the nominal step that begins has other pulls than the one before.
bool Simulation::other_pulls() const {
  const double now = nominal_start_ + dt_ / 2, before = nominal_start_ - dt_ / 2;
  return step_ > 0 && parts_.at_start() &&
         std::any_of(scene_.pulls.begin(), scene_.pulls.end(),
                     [&](const Pull& pull) { return pull.span.holds(now) != pull.span.holds(before); });
}

// Forces jump where vertices are let go or held, where pulls begin or end and where stitches break: an acceleration of
// before is not theirs.
void Simulation::begin_anew() {
  history_.anew = true;
  if (!method_.integrator->needs_acceleration()) return;
  Archive memory;
  system_->keep(memory);
  start_acceleration();
  Archive again(memory.bytes());
  system_->keep(again);
}

void Simulation::keep_motion(Archive& archive) {
  archive.section("simulation");
  archive(history_.steps, history_.dt_prev, history_.x, history_.v, history_.a, history_.x_prev,
          history_.v_prev, history_.t, history_.anew, step_, nominal_, nominal_start_, parts_);
  if (size_.adaptive()) archive(size_);
  if (scene_.stitches.first_breakable()) archive(broken_, broke_);
  if (held_.changes()) {
    std::vector<int> holding = held_.holding();
    archive(holding);
    hold_pins(std::move(holding));
  }
}

void Simulation::keep(Archive& archive) {
  keep_motion(archive);
  system_->keep(archive);
  if (archive.reads()) drop_caches();
  Archive solver;  // apart, since a system on a device has none
  if (!archive.reads()) system_->keep_solver(solver);
  std::string bytes = solver.bytes();
  archive(bytes);
  if (!archive.reads() || bytes.empty()) return;
  Archive read(std::move(bytes));
  system_->keep_solver(read);
}

void Simulation::drop_caches() { system_->drop_caches(); }

StepReport Simulation::step(StepObserver& observer) {
  const bool others =
      held_.changes() && parts_.at_start() && hold_pins(holding_pins(scene_, nominal_start_ + dt_ / 2));
  PhaseClock& clock = system_->clock();
  clock.restart(Phase::step_control);
  ChargedObserver charged(observer, clock);
  if (step_ == 0 && method_.integrator->needs_acceleration()) start_acceleration();
  if (others || other_pulls() || broke_) begin_anew();
  StepReport report = attempt_until_converged(charged);

  const int halvings = parts_.halvings();
  remember(system_->view().x(), report.dt_s);
  if (size_.adaptive()) choose_length(report, halvings);
  report.t_s = history_.t;
  measure_end(*system_, report);
  broke_ = report.broken_stitches > broken_;
  broken_ = report.broken_stitches;
  if (end_residual_ && report.status == StepStatus::converged) measure_residual(report);
  for (Eigen::Index i = 0; i < history_.v.cols(); ++i) {
    report.kinetic_J += 0.5 * held_.now().mass[static_cast<std::size_t>(i)] * history_.v.col(i).squaredNorm();
  }
  system_->end_step();
  report.time = clock.read();
  charged.on_step(*system_, report, history_.x);
  ++step_;
  report.time = clock.read();
  return report;
}

// After a step of dt / 2^halvings.
void Simulation::choose_length(const StepReport& report, int halvings) {
  const double error = size_.asks_for_error() ? embedded_error(history_.x_prev, history_.v_prev, history_.x,
                                                               history_.v, report.dt_s)
                                              : 0;
  size_.took(halvings, report.newton_iterations, error);
  parts_.choose(size_.halvings());
}

// The next part of the nominal step, from the history. The load of quasi_static grows with the parts.
StepReport Simulation::attempt(StepObserver& observer) {
  StepTask task;
  task.step = step_;
  task.dt = parts_.length(dt_);
  task.load_factor = method_.integrator->weight_factor();
  if (method_.integrator->quasi_static()) task.load_factor *= (nominal_ + parts_.end()) / n_steps_;
  load_factor_ = task.load_factor;
  task.history = &history_;
  task.integrator = method_.integrator.get();
  task.pose = [this](double dt, Positions& target) {
    for (const Pin& pin : held_.now().pins) target.col(pin.vertex) = pin_pose(scene_, pin, history_.t + dt);
    round_state(method_.precision, target);
  };
  StepReport report = solver_->advance(*system_, task, prediction_, observer);
  if (!declared(entry_.counters, report.solver)) {
    throw std::logic_error("counters of a step that " + entry_.name + " does not declare, or lacks");
  }
  return report;
}

// Every attempt but the first begins as a run that goes on from an archive of the start would. One whose
// motion is not proven is made again as long as it was; from there on all motions of the step are bounded,
// and nothing is left to prove.
StepReport Simulation::attempt_until_converged(StepObserver& observer) {
  Archive start;
  if (parts_.can_halve() || proves_steps_) keep(start);
  bool bounded = !proves_steps_;
  if (proves_steps_) system_->bound_audited(false);  // also after a step that something was thrown in
  StepReport report = attempt(observer);
  for (;;) {
    const bool halve = report.status != StepStatus::converged && parts_.can_halve();
    if (!halve && (bounded || is_proven(report))) break;
    bounded = bounded || !halve;
    go_back(start, halve, proves_steps_ && bounded);
    halve ? observer.on_retry(step_) : observer.on_redo(step_);
    StepReport again = attempt(observer);
    halve ? again.add_attempt(report, entry_.counters) : again.add_unproven(report, entry_.counters);
    report = std::move(again);
  }
  if (proves_steps_) system_->bound_audited(false);
  return report;
}

bool Simulation::is_proven(StepReport& report) {
  const StepBound proof = system_->prove_step();
  report.ccd_queries += proof.queries, report.audited_queries += proof.queries;
  report.ccd_probes += proof.probes;
  return proof.alpha == 1;
}

void Simulation::go_back(const Archive& start, bool halve, bool bound_audited) {
  const StepParts parts = parts_;
  Archive again(start.bytes());
  keep(again);
  parts_ = parts;
  if (halve) parts_.halve();
  if (bound_audited) system_->bound_audited(true);
}

// a_0 = M^-1 (f - grad(Psi + B + S)) at the start, of vertices that do not move against the air or a contact; 0 at prescribed
// degrees of freedom.
void Simulation::start_acceleration() {
  Prediction at_rest;
  method_.integrator->predict(history_, dt_, at_rest);  // for its c
  at_rest.x_tilde = history_.x;
  at_rest.t_end = history_.t;
  at_rest.at_start = true;
  system_->begin_step(history_.x, at_rest, dt_, 1.0);
  system_->assemble();
  for (Eigen::Index i = 0; i < history_.a.cols(); ++i) {
    const double mass = held_.now().mass[static_cast<std::size_t>(i)];
    for (Eigen::Index k = 0; k < 3; ++k) {
      const bool fixed = system_->view().fixed()[static_cast<std::size_t>(3 * i + k)] != 0;
      history_.a(k, i) = fixed ? 0 : -system_->view().gradient()(k, i) / mass;
    }
  }
}

// The last prediction is the one that the end belongs to.
void Simulation::measure_residual(StepReport& report) {
  const StepFrame frame{history_.x_prev, prediction_.x_tilde, report.dt_s,
                        prediction_.c,   load_factor_,        prediction_.t_end};
  report.end_error_m = end_residual_->measure(*system_, frame);
  if (report.end_error_m.finite()) {
    report.end_error_tolerances = report.end_error_m.value / (report.dt_s * method_.step_solver.tol_velocity);
  }
}

void Simulation::remember(const PositionsView& x, double dt_used) {
  const ScopedPhase timer(system_->clock(), Phase::prediction);
  if (dt_used > 0) {
    method_.integrator->finish(history_, dt_used, prediction_, x, v_next_, a_next_);
    damp_velocities(held_.now(), x, dt_used, v_next_);
    follow_pins(history_.t + dt_used, dt_used);
    history_.v_prev.swap(history_.v);
    history_.v = v_next_;
    if (method_.integrator->needs_acceleration()) history_.a = a_next_;
    history_.dt_prev = dt_used;
    history_.anew = false;
  }
  history_.x_prev.swap(history_.x);
  history_.x = x;
  ++history_.steps;
  advance_time(dt_used);
}

// A formula of second order takes a kink in the way of a prescribed vertex for a velocity that swings on without end. Nobody sees
// that while it is held; what it is let go with is the velocity of its motion. First order has that of the step.
void Simulation::follow_pins(double t_end, double dt) {
  const Integrator& integrator = *method_.integrator;
  if (!held_.changes() || integrator.velocity_of_step()) return;
  for (const Pin& pin : held_.now().pins) {
    v_next_.col(pin.vertex) = pin_velocity(scene_, pin, t_end, dt);
    if (integrator.needs_acceleration()) a_next_.col(pin.vertex).setZero();
  }
}

// At the end of a nominal step the time is what it would be without its parts. accumulated_toi ends a step
// where it got to, and the next nominal step begins there.
void Simulation::advance_time(double dt_used) {
  const bool reached = dt_used == parts_.length(dt_);
  if (!reached) {
    history_.t += dt_used;
  } else {
    history_.t = nominal_start_ + (parts_.ends_here() ? dt_ : parts_.end() * dt_);
  }
  parts_.next(reached);
  if (!parts_.at_start()) return;
  ++nominal_;
  nominal_start_ = history_.t;
}

}  // namespace bb
