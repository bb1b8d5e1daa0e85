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
  if (cycles(step.kappa_unsettled))
    text = unsettled("the contacts'", step.kappa_change, step.newton_iterations);
  if (!cycles(step.limit_kappa_unsettled)) return text;
  return text + (text.empty() ? "" : "; ") +
         unsettled("the strain limit's", step.limit_kappa_change, step.newton_iterations);
}

/// What the rows of a state say, both tables; loads and curvature of unmollified rows alone, since a
/// mollified one has e(x) kappa |b'|.
struct RowMeasures {
  double gap_min_rel = std::numeric_limits<double>::infinity();
  double kappa_min = std::numeric_limits<double>::infinity(), kappa_max = 0;
  double load_max = 0, load_sum = 0, curvature_max = 0;
};

RowMeasures measure_rows(const EnergyState& state) {
  RowMeasures out;
  const auto common = [&out](const auto& rows) {
    for (std::size_t r = 0; r < rows.size(); ++r) {
      out.kappa_min = std::min(out.kappa_min, rows.kappa[r]);
      out.kappa_max = std::max(out.kappa_max, rows.kappa[r]);
      out.gap_min_rel = std::min(out.gap_min_rel, rows.d[r] / rows.d_hat[r]);
    }
  };
  common(state.rows);
  common(state.mollified);
  const ContactTable& rows = state.rows;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    out.curvature_max = std::max(out.curvature_max, rows.multiplicity[r] * rows.kappa[r] * rows.d2b[r]);
    out.load_max = std::max(out.load_max, -rows.kappa[r] * rows.db[r]);
    out.load_sum -= rows.multiplicity[r] * rows.kappa[r] * rows.db[r];
  }
  return out;
}

template <class Report>
Number with_rows(const Report& report, double value) {
  return report.contacts.total() > 0 ? Number(value) : Number::missing("no_contacts");
}

/// What an iteration and a step both say of contact and strain limit.
template <class Report>
void fill_contact(const NewtonSystem& system, const RowMeasures& rows, Report& report) {
  report.contacts = system.contact_counts();
  report.kappa_min_N_per_m = with_rows(report, rows.kappa_min);
  report.kappa_max_N_per_m = with_rows(report, rows.kappa_max);
  report.contact_load_max_N = with_rows(report, rows.load_max);
  report.max_stretch = system.has_limit() ? Number(system.max_stretch()) : Number::missing("no_limit");
  report.limit_load_max_N_per_m =
      system.has_limit() ? Number(system.limit_load_max()) : Number::missing("no_limit");
}

/// What the linear solver and the step bound did, in the words of the trace.
void fill_work(IterationReport& report) {
  const LinearReport& linear = report.linear;
  report.linear_status = linear.status;
  report.residual_true = linear.residual_true;
  const auto iterative = [&linear](double value) {
    return linear.iterations > 0 ? Number(value) : Number::missing("direct_solver");
  };
  report.residual_recurrence = iterative(linear.residual_recurrence);
  report.ritz_min = iterative(linear.ritz_min);
  report.ritz_max = iterative(linear.ritz_max);
  report.linear_solves = 1;
  report.linear_iterations = linear.iterations;
  report.factorizations = linear.factorized;
  report.analyses = linear.analyzed;
  report.ccd_queries = report.bound.queries;
  report.ccd_probes = report.bound.probes;
  report.ccd_capped = report.bound.capped;
  report.ccd_zero = report.bound.zero;
}

/// Counts on or starts again; returns the change, 0 where there is none.
double follow(const Number& change, int& unsettled) {
  const double value = change.finite() ? change.value : 0;
  unsettled = value > settled_kappa ? unsettled + 1 : 0;
  return value;
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
  step.gap_min_iterates_m = step.gap_min_iterates_rel = Number::missing("no_contacts");
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

  report.energy_J = system.energy();
  report.grad_inf_N = system.grad_inf();
  report.pattern_changed = system.pattern_changed();
  const RowMeasures rows = measure_rows(system.state());
  fill_contact(system, rows, report);
  report.gap_min_iterates_m = with_rows(report, system.state().gap_min);
  report.gap_min_iterates_rel = with_rows(report, rows.gap_min_rel);
  report.contact_curvature_max_N_per_m = with_rows(report, rows.curvature_max);
  const bool first = iteration == 0;
  report.kappa_change_rel = first ? Number::missing("first_iteration") : Number(system.kappa_change());
  report.limit_kappa_change_rel = !system.has_limit() ? Number::missing("no_limit")
                                  : first             ? Number::missing("first_iteration")
                                                      : Number(system.limit_kappa_change());
  report.limit_gap_min_rel =
      system.has_limit() ? Number(system.limit_gap_min_rel()) : Number::missing("no_limit");
  return report;
}

void measure_direction(const NewtonSystem& system, const Positions& dx, IterationReport& report) {
  const Positions& gradient = system.gradient();
  double slope = 0;
  report.dx_inf_m = 0;
  for (Eigen::Index i = 0; i < dx.size(); ++i) {
    if (system.fixed()[static_cast<std::size_t>(i)]) continue;
    slope += gradient.data()[i] * dx.data()[i];
    const double size = std::abs(dx.data()[i]);
    report.dx_inf_m = size > report.dx_inf_m || std::isnan(size) ? size : report.dx_inf_m;
  }
  report.decrement_J = -slope / 2;
  report.n_free = static_cast<std::size_t>(system.n_free());
  report.nnz = system.nnz();
}

std::optional<StepStatus> direction_failure(const IterationReport& report, bool must_descend) {
  if (report.linear.status != LinearStatus::ok) return StepStatus::linear_failed;
  if (!std::isfinite(report.dx_inf_m) || !std::isfinite(report.decrement_J)) return StepStatus::non_finite;
  if (must_descend && report.decrement_J <= 0) return StepStatus::not_descent;
  return std::nullopt;
}

void finish_iteration(NewtonSystem& system, StepReport& step, IterationReport& report,
                      StepObserver& observer) {
  report.time = system.clock().lap();
  fill_work(report);
  ++step.newton_iterations;
  step += report;
  step.kappa_change = follow(report.kappa_change_rel, step.kappa_unsettled);
  step.limit_kappa_change = follow(report.limit_kappa_change_rel, step.limit_kappa_unsettled);
  step.alpha_ccd_min = std::min(step.alpha_ccd_min, report.alpha_ccd);
  keep_smaller(step.gap_min_iterates_m, report.gap_min_iterates_m);
  keep_smaller(step.gap_min_iterates_rel, report.gap_min_iterates_rel);
  observer.on_iteration(report);
}

bool poses_reached(const NewtonSystem& system, const Positions& target) {
  for (const Pin& pin : system.scene().pins) {
    if (system.state().x.col(pin.vertex) != target.col(pin.vertex)) return false;
  }
  return true;
}

std::string describe_bound(NewtonSystem& system, const IterationReport& report) {
  if (report.alpha_strain < report.alpha_ccd) return "held by the strain limit";
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
  const RowMeasures rows = measure_rows(system.state());
  fill_contact(system, rows, step);
  step.contact_load_sum_N = with_rows(step, rows.load_sum);
  const Number gap = with_rows(step, system.state().gap_min), gap_rel = with_rows(step, rows.gap_min_rel);
  keep_smaller(step.gap_min_iterates_m, gap);
  keep_smaller(step.gap_min_iterates_rel, gap_rel);
  const bool converged = step.status == StepStatus::converged;
  step.gap_min_m = converged ? gap : Number::missing("not_converged");
  step.gap_min_rel = converged ? gap_rel : Number::missing("not_converged");
  step.contact_overload = step.limit_overload = Number::missing(converged ? "converged" : "not_measured");
  const bool stalled = step.status == StepStatus::iteration_cap || step.status == StepStatus::step_collapse ||
                       step.status == StepStatus::line_search_failed ||
                       step.status == StepStatus::not_descent;
  if (!stalled) return;
  if (const std::string moving = describe_unsettled(step); !moving.empty()) {
    step.detail = moving + (step.detail.empty() ? "" : "; " + step.detail);
    step.contact_overload = step.limit_overload = Number::missing("kappa_unsettled");
    return;  // what a kappa that moves can carry is no number
  }
  system.assemble();  // the rows that were accepted last and their gradients, of one state
  Positions dx;       // prescribed vertices stay where they are
  const bool solved = system.solve(system.state().x, dx).status == LinearStatus::ok;
  if (!solved) dx.setZero();
  step.contact_overload = system.contact_overload(dx);
  step.limit_overload = system.limit_overload(dx);
}

}  // namespace bb
