#include "core/newton/iteration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace bb {
namespace {

/// What the linear solver and the step bound did, in the words of the trace.
void fill_work(IterationReport& report) {
  const LinearReport& linear = report.solve.linear;
  report.linear_status = linear.status;
  report.residual_true = linear.residual_true;
  report.linear_tolerance = report.residual_recurrence = report.ritz_min = report.ritz_max =
      Number::missing("direct_solver");
  if (linear.iterative) {
    report.linear_tolerance = linear.tolerance;
    report.residual_recurrence = linear.residual_recurrence;
    const bool known = linear.ritz_max != 0;  // not where the solve ended before its first iteration
    report.ritz_min = known ? Number(linear.ritz_min) : Number::missing("not_measured");
    report.ritz_max = known ? Number(linear.ritz_max) : Number::missing("not_measured");
  }
  report.hessian_t = report.solve.t;
  report.hessian_fallbacks = std::max(0, report.solve.fallbacks());  // without a solve there are none
  report.linear_solves = report.solve.attempts + report.solve.corrections;
  report.linear_iterations = linear.iterations;
  report.factorizations = report.solve.factorizations;
  report.factor_flop = std::llround(report.solve.factor_flop);
  report.factor_nnz = linear.factor_nnz > 0 ? Number(linear.factor_nnz) : Number::missing("no_factor");
  report.analyses = report.solve.analyses;
  report.ccd_queries = report.bound.queries;
  report.ccd_probes = report.bound.probes;
  report.ccd_capped = report.bound.capped;
  report.ccd_zero = report.bound.zero;
}

}  // namespace

void aim_at_poses(StepSystem& system, const StepTask& task, double dt) {
  Positions target = task.history->x;
  task.pose(dt, target);
  system.set_target(target);
}

StepReport start_step(StepSystem& system, const StepTask& task, Prediction& used) {
  const ScopedPhase timer(system.clock(), Phase::prediction);
  task.integrator->predict(*task.history, task.dt, used);
  used.t_end = task.history->t + task.dt;
  system.begin_step(task.history->x, used, task.dt, task.load_factor);
  aim_at_poses(system, task, task.dt);
  StepReport step;
  step.step = task.step;
  step.dt_s = task.dt;
  step.status = StepStatus::iteration_cap;
  return step;
}

double rounding_of(const EnergyChange& change, Precision precision) {
  return 64 * value_epsilon(precision) * change.magnitude;
}
bool within_rounding(const EnergyChange& change, Precision precision) {
  return std::abs(change.change) <= rounding_of(change, precision);
}

void require_on_host(const StepSystem& system, std::string_view solver) {
  if (system.is_on_host()) return;
  throw ConfigError("/device", "one beside the processor", "cpu: the step solver is " + std::string(solver));
}

void require_unmoved(const Scene& scene, std::string_view solver) {
  const std::string why = "the step solver is " + std::string(solver);
  for (const PrescribedMotion& motion : scene.motions) {
    if (!motion.is_static())
      throw ConfigError("/scene", "prescribed vertices or obstacles that move", "none: " + why);
  }
  for (const Pin& pin : scene.pins) {
    if (!(pin.span.hold > 0)) continue;
    throw ConfigError(
        "/scene", fmt::format("a pin that holds vertex {} from hold_s = {} on", pin.vertex, pin.span.hold),
        "pins that hold from the start, since none leads its vertex to its place: " + why);
  }
}

void require_unbreakable(const Scene& scene, std::string_view solver) {
  const auto first = scene.stitches.first_breakable();
  if (!first) return;
  throw ConfigError(
      "/scene/stitches",
      fmt::format("a stitch that breaks at strength_N = {:g}", scene.stitches.strength[*first]),
      fmt::format("stitches without strength_N: the step solver {} pulls ends together by another stiffness "
                  "than theirs, so that their tension is not known",
                  solver));
}

void fail_step(const StepSystem& system, StepReport& step, StepStatus status, const IterationReport& report) {
  step.status = status;
  if (status == StepStatus::non_finite) step.detail = system.view().describe_non_finite();
  if (status == StepStatus::not_descent) {
    char text[80];
    std::snprintf(text, sizeof text, "g . dx = %.3g J along the last direction", -2 * report.decrement_J);
    step.detail = text;
  }
  if (status != StepStatus::linear_failed) return;
  const LinearReport& linear = report.solve.linear;
  step.detail = std::string(to_string(linear.status)) + (linear.detail.empty() ? "" : ": " + linear.detail);
}

IterationReport begin_iteration(StepSystem& system, int step, int iteration) {
  IterationReport report;
  report.step = step;
  report.iteration = iteration;
  system.clock().lap();
  system.assemble();
  system.view().announce();
  return report;
}

namespace {

// What was announced, read with the direction.
void report_iterate(const StepSystem& system, IterationReport& report) {
  report.energy_J = system.view().energy();
  report.grad_inf_N = system.view().grad_inf();
  report.pattern_changed = system.view().pattern_changed();
  system.view().report(report);
  if (report.iteration == 0) report.forget_changes();
}

}  // namespace

void find_direction(StepSystem& system, IterationReport& report, StepObserver& observer) {
  report.solve = system.find_direction();
  report_direction(system, report, observer);
}

void report_direction(StepSystem& system, IterationReport& report, StepObserver& observer) {
  const DirectionSize size = system.direction_size();
  report.dx_inf_m = size.inf_m;
  report.dx_beyond_m = size.beyond_m;
  report.dx_rounding_m = size.rounding_m;
  report.decrement_J = -size.slope_J / 2;
  report_iterate(system, report);
  report.n_free = static_cast<std::size_t>(system.view().n_free());
  report.nnz = system.view().nnz();
  observer.on_matrix(system, report.step, report.iteration);
}

std::optional<StepStatus> direction_failure(const IterationReport& report, bool must_descend) {
  if (report.solve.linear.status == LinearStatus::non_finite) return StepStatus::non_finite;
  if (report.solve.linear.status != LinearStatus::ok) return StepStatus::linear_failed;
  if (!std::isfinite(report.dx_inf_m) || !std::isfinite(report.decrement_J)) return StepStatus::non_finite;
  if (must_descend && report.decrement_J <= 0) return StepStatus::not_descent;
  return std::nullopt;
}

EndCheck check_end(StepSystem& system, SaddleRule rule, StepReport& step, IterationReport& report) {
  if (rule == SaddleRule::ignore) return {};
  const EndCheck end = system.check_end();
  ++report.end_checks;
  report.end_check_factorizations += end.factorizations;
  report.end_check_iterations += end.iterations;
  step.cusps = end.cusps;
  step.first_cusp = end.first_cusp;
  if (end.proof == EndProof::saddle) keep_smaller(step.saddle_curvature_N_per_m, end.curvature_N_per_m);
  return end;
}

void end_converged(StepReport& step, const EndCheck& end, const Number& error, double asked) {
  step.status = StepStatus::converged;
  step.end_proof = end.proof;
  step.end_error_m = error;
  if (error.finite()) step.end_error_tolerances = error.value / asked;
}

void finish_iteration(StepSystem& system, StepReport& step, IterationReport& report, StepObserver& observer) {
  report.time = system.clock().lap();
  fill_work(report);
  ++step.newton_iterations;
  step.add(report);
  observer.on_iteration(report);
}

void show_motion(const StepSystem& system, int step, StepObserver& observer) {
  if (observer.watches_motions()) observer.on_motion(system.view().x_before(), system.view().x(), step);
}

std::string describe_bound(const StepSystem& system) {
  const std::string holder = system.view().describe_bound();
  return holder.empty() ? "no bound held it" : "held by " + holder;
}

std::string describe_short_pin(const StepSystem& system, const StepTask& task) {
  const Scene& scene = system.view().scene();
  Positions target = task.history->x;
  task.pose(task.dt, target);
  for (const Pin& pin : scene.pins) {
    if (system.view().x().col(pin.vertex) == target.col(pin.vertex)) continue;
    const int body = scene.body[static_cast<std::size_t>(pin.vertex)];
    return "pinned vertex " + std::to_string(pin.vertex) + " of body '" +
           scene.bodies[static_cast<std::size_t>(body)].name + "' cannot reach its pose, " +
           describe_bound(system);
  }
  return {};
}

void measure_end(StepSystem& system, StepReport& step) {
  system.view().report_end(step);
  step.close();
  const bool stalled = step.status == StepStatus::iteration_cap || step.status == StepStatus::step_collapse ||
                       step.status == StepStatus::line_search_failed ||
                       step.status == StepStatus::not_descent;
  if (!stalled) return;
  if (const std::string moving = step.describe_unsettled(); !moving.empty()) {
    step.detail = moving + (step.detail.empty() ? "" : "; " + step.detail);
    step.contact_overload = step.limit_overload = Number::missing("kappa_unsettled");
    return;  // what a kappa that moves can carry is not one number
  }
  system.take_secant(0);
  system.assemble();  // the rows that were accepted last and their gradients, of one state
  system.set_target(system.view().x());
  const bool solved = system.find_direction().linear.status == LinearStatus::ok;
  step.begin_overload();
  system.view().report_overload(solved, step);
}

}  // namespace bb
