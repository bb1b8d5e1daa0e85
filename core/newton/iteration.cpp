#include "core/newton/iteration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bb {

StepReport start_step(NewtonSystem& system, const StepTask& task, Prediction& used, Positions& target) {
  const ScopedPhase timer(system.clock(), Phase::prediction);
  task.integrator->predict(*task.history, task.dt, used);
  system.begin_step(task.history->x, used, task.dt, task.load_factor);
  target = task.history->x;
  task.pose(task.dt, target);
  StepReport step;
  step.step = task.step;
  step.dt_used = task.dt;
  step.status = StepStatus::iteration_cap;
  return step;
}

bool within_rounding(const EnergyChange& change) {
  return std::abs(change.change) <= 64 * std::numeric_limits<double>::epsilon() * change.magnitude;
}

void fail_step(StepReport& step, StepStatus status, const IterationReport& report) {
  step.status = status;
  if (status == StepStatus::linear_failed) step.detail = std::string(to_string(report.linear.status));
}

IterationReport begin_iteration(NewtonSystem& system, int step, int iteration, StepObserver& observer) {
  IterationReport report;
  report.step = step;
  report.iteration = iteration;
  system.clock().lap();
  system.assemble();
  observer.on_matrix(system, step, iteration);

  report.energy = system.energy();
  report.grad_inf = system.grad_inf();
  report.pattern_changed = system.pattern_changed();
  system.report(report);
  return report;
}

void measure_direction(const NewtonSystem& system, const Positions& dx, IterationReport& report) {
  const Positions& gradient = system.gradient();
  double slope = 0;
  report.dx_inf = 0;
  for (Eigen::Index i = 0; i < dx.size(); ++i) {
    if (system.fixed()[static_cast<std::size_t>(i)]) continue;
    slope += gradient.data()[i] * dx.data()[i];
    const double size = std::abs(dx.data()[i]);
    report.dx_inf = size > report.dx_inf || std::isnan(size) ? size : report.dx_inf;
  }
  report.decrement = -slope;
  report.n_free = static_cast<std::size_t>(system.n_free());
  report.nnz = system.nnz();
}

std::optional<StepStatus> direction_failure(const IterationReport& report, bool must_descend) {
  if (report.linear.status != LinearStatus::ok) return StepStatus::linear_failed;
  if (!std::isfinite(report.dx_inf) || !std::isfinite(report.decrement)) return StepStatus::non_finite;
  if (must_descend && report.decrement <= 0) return StepStatus::not_descent;
  return std::nullopt;
}

void finish_iteration(NewtonSystem& system, StepReport& step, IterationReport& report,
                      StepObserver& observer) {
  report.times = system.clock().lap();
  ++step.iterations;
  step.linear_iterations += report.linear.iterations;
  step.line_search_trials += report.line_search_trials;
  step.factorizations += report.linear.factorized;
  step.analyses += report.linear.analyzed;
  step.accepted_by_rounding += report.accepted_by_rounding;
  step.add(report);
  step.alpha_min = std::min(step.alpha_min, report.alpha);
  observer.on_iteration(report);
}

bool poses_reached(const NewtonSystem& system, const Positions& target) {
  for (const Pin& pin : system.scene().pins) {
    if (system.x().col(pin.vertex) != target.col(pin.vertex)) return false;
  }
  return true;
}

std::string describe_bound(const NewtonSystem& system) {
  const std::string holder = system.describe_bound();
  return holder.empty() ? "no bound held it" : "held by " + holder;
}

std::string describe_short_pin(const NewtonSystem& system, const Positions& target) {
  const Scene& scene = system.scene();
  for (const Pin& pin : scene.pins) {
    if (system.x().col(pin.vertex) == target.col(pin.vertex)) continue;
    const int body = scene.body[static_cast<std::size_t>(pin.vertex)];
    return "pinned vertex " + std::to_string(pin.vertex) + " of body '" +
           scene.bodies[static_cast<std::size_t>(body)].name + "' cannot reach its pose";
  }
  return {};
}

void measure_end(NewtonSystem& system, StepReport& step) {
  system.report_end(step);
  const bool stalled = step.status == StepStatus::iteration_cap || step.status == StepStatus::step_collapse ||
                       step.status == StepStatus::line_search_failed ||
                       step.status == StepStatus::not_descent;
  if (!stalled) return;
  if (const std::string moving = step.describe_unsettled(step.iterations); !moving.empty()) {
    step.detail = moving + (step.detail.empty() ? "" : "; " + step.detail);
    return;  // what a kappa that moves can carry is no number
  }
  system.assemble();  // the rows that were accepted last and their gradients, of one state
  Positions dx;       // prescribed vertices stay where they are
  const bool solved = system.solve(system.x(), dx).status == LinearStatus::ok;
  if (!solved) dx.setZero();
  step.begin_overload();
  system.report_overload(dx, step);
}

}  // namespace bb
