#include "core/newton/iteration.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace bb {
namespace {

constexpr double settled_kappa = 0.01;    // a change below it leaves Newton alone
constexpr int unsettled_iterations = 10;  // that many above it in a row are a cycle, not a transient

bool cycles(int unsettled) { return unsettled >= unsettled_iterations; }

std::string unsettled(const char* whose, double change, int iterations) {
  char text[180];
  std::snprintf(
      text, sizeof text,
      "%s kappa does not settle: refreshed in every iteration, it still changes by a factor of %.3g "
      "after %d iterations",
      whose, 1 + change, iterations);
  return text;
}

/// Names which kappa does not settle; empty when both do.
std::string describe_unsettled(const StepReport& step) {
  std::string text;
  if (cycles(step.kappa_unsettled)) text = unsettled("the contacts'", step.kappa_change, step.iterations);
  if (!cycles(step.limit_kappa_unsettled)) return text;
  return text + (text.empty() ? "" : "; ") +
         unsettled("the strain limit's", step.limit_kappa_change, step.iterations);
}

}  // namespace

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
  report.contacts = system.contact_counts();
  report.gap_min = system.state().gap_min;
  report.max_stretch = system.max_stretch();
  report.limit_tension = system.limit_tension_max();
  report.kappa_change = system.kappa_change();
  report.limit_kappa_change = system.limit_kappa_change();
  report.limit_gap_min_rel = system.limit_gap_min_rel();
  report.gap_min_rel = std::numeric_limits<double>::infinity();
  const auto common = [&report](const auto& rows, bool& first) {
    for (std::size_t r = 0; r < rows.size(); ++r) {
      report.kappa_min = first ? rows.kappa[r] : std::min(report.kappa_min, rows.kappa[r]);
      report.kappa_max = std::max(report.kappa_max, rows.kappa[r]);
      report.gap_min_rel = std::min(report.gap_min_rel, rows.d[r] / rows.d_hat[r]);
      first = false;
    }
  };
  bool first = true;
  common(system.state().rows, first);
  common(system.state().mollified, first);
  const ContactTable& rows =
      system.state().rows;  // a mollified row has e(x) kappa |b'| and no load of its own
  for (std::size_t r = 0; r < rows.size(); ++r) {
    report.curvature_max = std::max(report.curvature_max, rows.multiplicity[r] * rows.kappa[r] * rows.d2b[r]);
    report.force_max = std::max(report.force_max, -rows.kappa[r] * rows.db[r]);
  }
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
  step.kappa_unsettled = in_a_row(step.kappa_unsettled, report.kappa_change > settled_kappa);
  step.kappa_change = report.kappa_change;
  step.limit_kappa_unsettled =
      in_a_row(step.limit_kappa_unsettled, report.limit_kappa_change > settled_kappa);
  step.limit_kappa_change = report.limit_kappa_change;
  step.alpha_min = std::min(step.alpha_min, report.alpha);
  step.alpha_ccd_min = std::min(step.alpha_ccd_min, report.alpha_ccd);
  step.ccd_queries += report.bound.queries;
  step.ccd_probes += report.bound.probes;
  step.ccd_capped += report.bound.capped;
  step.ccd_zero += report.bound.zero;
  observer.on_iteration(report);
}

bool poses_reached(const NewtonSystem& system, const Positions& target) {
  for (const Pin& pin : system.scene().pins) {
    if (system.state().x.col(pin.vertex) != target.col(pin.vertex)) return false;
  }
  return true;
}

std::string describe_bound(NewtonSystem& system, const IterationReport& report) {
  if (report.alpha_limit < report.alpha_ccd) return "held by the strain limit";
  return "held by " + system.contacts().describe(report.bound.key, report.bound.kind);
}

std::string describe_short_pin(const NewtonSystem& system, const Positions& target) {
  const Scene& scene = system.scene();
  for (const Pin& pin : scene.pins) {
    if (system.state().x.col(pin.vertex) == target.col(pin.vertex)) continue;
    const int body = scene.body[static_cast<std::size_t>(pin.vertex)];
    return "pinned vertex " + std::to_string(pin.vertex) + " of body '" +
           scene.bodies[static_cast<std::size_t>(body)].name + "' cannot reach its pose";
  }
  return {};
}

void measure_end(NewtonSystem& system, StepReport& step) {
  const ContactTable& rows = system.state().rows;
  step.contacts = system.contact_counts();
  step.gap_min = system.state().gap_min;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    step.force_max = std::max(step.force_max, -rows.kappa[r] * rows.db[r]);
  }
  step.max_stretch = system.max_stretch();
  step.limit_tension_max = system.limit_tension_max();
  const bool stalled = step.status == StepStatus::iteration_cap || step.status == StepStatus::step_collapse ||
                       step.status == StepStatus::line_search_failed ||
                       step.status == StepStatus::not_descent;
  if (!stalled) return;
  if (const std::string moving = describe_unsettled(step); !moving.empty()) {
    step.detail = moving + (step.detail.empty() ? "" : "; " + step.detail);
    return;  // what a kappa that moves can carry is no number
  }
  system.assemble();  // the rows that were accepted last and their gradients, of one state
  Positions dx;       // prescribed vertices stay where they are
  const bool solved = system.solve(system.state().x, dx).status == LinearStatus::ok;
  if (!solved) dx.setZero();
  step.overload = system.contact_overload(dx);
  step.limit_overload = system.limit_overload(dx);
}

}  // namespace bb
