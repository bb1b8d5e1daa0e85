// One time step by Newton's method. Read this file first: it is the whole method, but for the lengths of a step
// (4 to 6, step_search.cpp).
//
//   1 assemble gradient and Hessian at x, kappa refreshed by its policy
//   2 solve A dx = -g, prescribed motion lifted to the right-hand side; A is the Hessian, as near to the exact
//     one as positive definiteness allows
//   3 stop when the estimated error of x + dx is below h tol_velocity, every prescribed vertex is at its pose
//     and the exact Hessian is positive definite; from a saddle go on along negative curvature
//   4 bound the step: ACCD over all pairs, strain limit; cap_fraction of a bound that binds. Where contact bounds each
//     vertex by itself, dx of each is cut to what it may go, as long as that descends
//   5 Armijo on E, kappa frozen; every trial state is re-checked as rounded; where curved gaps hold the step, first
//     with a curvature correction for them; where steps crawl, first along a longer dx
//   6 accept; what converged goes on where terms renew their lagged contact state. A step that was shortened requests the secant of terms
//     that have one (secant_rule.hpp), and so does one along which E falls nowhere, before the step fails

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/newton/crawl_watch.hpp"
#include "core/newton/error_estimate.hpp"
#include "core/newton/iteration.hpp"
#include "core/newton/line_search.hpp"
#include "core/newton/secant_rule.hpp"
#include "core/newton/step_search.hpp"

namespace bb {
namespace {

constexpr double collapsed_step = 1e-8;  // a step below it counts as no progress
constexpr int collapse_iterations = 10;  // that many in a row end the step
constexpr int most_escapes = 10;         // in a step; a saddle after that many is reported as one

class LineSearch final : public StepSolver {
 public:
  LineSearch(const StepSolverOptions& options, const LineSearchRules& rules)
      : options_(options),
        search_(number(options.parameters, "armijo"), rules.cap_fraction, rules.bounded),
        gradient_tolerance_(rules.gradient_tolerance),
        after_motion_(rules.after_motion) {}
  std::string_view name() const override { return options_.name; }

  StepReport advance(StepSystem& system, const StepTask& task, Prediction& used,
                     StepObserver& observer) override {
    StepReport step = start_step(system, task, used);
    begin_search(step);
    const double tolerance = tolerance_of(system, task.dt);
    for (int iteration = 0; iteration < options_.max_iterations; ++iteration) {
      IterationReport report = begin_iteration(system, task.step, iteration);  // 1
      find_direction(system, report, observer);                                // 2
      const bool at_pose = system.view().at_target();
      const bool small = is_small(system, report, tolerance) && at_pose;  // 3
      if (secant_.share() > 0) ++*secants_;
      if (const auto failed = direction_failure(report, at_pose && !small)) {
        finish_iteration(system, step, report, observer);
        fail_step(system, step, *failed, report);
        return step;
      }
      const EndCheck end = small ? check_end(system, options_.saddle, step, report) : EndCheck();
      const bool escaped = is_no_minimum(end.proof) && escape_saddle(system, end, report, tolerance);
      const bool moved = escaped || follow_direction(system, report, at_pose, small);  // 4 to 6
      finish_iteration(system, step, report, observer);
      if (moved) show_motion(system, task.step, observer);
      if (escaped) continue;
      if (moved && after_motion_ && after_motion_(system)) {
        begin_anew(iteration);
      } else if (small && (level_ || is_enough(report, moved, tolerance))) {
        if (!system.renew_lagged_state()) {
          end_in_minimum(step, end, report, task.dt);
          return step;
        }
        begin_anew(iteration);
      } else if (turn_to_secant(system, moved, at_pose, iteration + 1 == options_.max_iterations)) {
        continue;
      } else if (gives_up(system, task, report, moved, at_pose, step)) {
        return step;
      }
      secant_.took(search_.shortened(), system);
    }
    end_at_cap(step);
    return step;
  }

 private:
  void begin_search(StepReport& step) {
    search_.begin_step(step);
    error_.reset();
    crawl_.begin_step();
    secant_.begin_step();
    secants_ = &(step.solver.values["secants"] = 0);
    collapsed_ = escapes_ = 0;
  }

  // Of 3: a step out of a saddle along negative curvature, or away from a cusp, which shows nothing about the rate. False where
  // the rule has none, after most_escapes of them, and where E is level; dx is what is left then.
  bool escape_saddle(StepSystem& system, const EndCheck& end, IterationReport& report, double tolerance) {
    if (options_.saddle != SaddleRule::escape || escapes_ >= most_escapes) return false;
    if (!search_.out_of_saddle(system, end.proof, report, tolerance)) return false;
    ++escapes_;
    error_.took(0);
    crawl_.reset();
    secant_.reset(system);
    return true;
  }

  // 4 to 6: a motion along dx, or a curvature correction or lengthening of it, and what it says about the rate. True where one was
  // accepted.
  bool follow_direction(StepSystem& system, IterationReport& report, bool at_pose, bool small) {
    const bool moved = search_.along_direction(system, report, at_pose, small, crawl_.length());
    const bool truncated = search_.truncated();
    // another direction than dx, or another length of it, shows nothing about the rate
    error_.took(report.detours > 0 || truncated || search_.taken() > 1 ? 0 : report.alpha);
    crawl_.took(moved && !truncated && !search_.noise() ? search_.taken() : 0, report);
    return moved;
  }

  bool gradient_is_small(const StepSystem& system) const {
    if (!(gradient_tolerance_ > 0)) return false;
    const PositionsView gradient = system.view().gradient();
    double sum = 0;
    for (Eigen::Index i = 0; i < gradient.size(); ++i) {
      if (system.view().fixed()[static_cast<std::size_t>(i)] != 0) continue;
      sum += gradient.data()[i] * gradient.data()[i];
    }
    return std::sqrt(sum) < gradient_tolerance_;
  }

  // Whether the estimated error of x + dx is below the tolerance, m, or the gradient at x below that of the rules.
  bool is_small(const StepSystem& system, IterationReport& report, double tolerance) {
    level_ = gradient_is_small(system);
    return estimate_error(report) < tolerance || level_;
  }

  // Of x + dx, m.
  double estimate_error(IterationReport& report) {
    error_.add(report.dx_beyond_m, report.solve.linear.residual_true, report.dx_rounding_m);
    report.contraction = error_.contraction();
    report.error_estimate_m = error_.error();
    return error_.error();
  }

  // Of a last direction of which a part was taken, the rest, m: the estimate is that of its end.
  double left_of(const IterationReport& report) const {
    return search_.truncated() ? report.dx_beyond_m : std::abs(1 - search_.taken()) * report.dx_beyond_m;
  }

  // m. In float no step has a tolerance below the rounding of the coordinates that are free to move.
  double tolerance_of(const StepSystem& system, double dt) const {
    const double asked = options_.tol_velocity * dt;
    if (!values_in_float(system.view().precision())) return asked;
    double largest = 0;
    for (Eigen::Index i = 0; i < system.view().x().size(); ++i) {
      if (system.view().fixed()[static_cast<std::size_t>(i)] == 0)
        largest = std::max(largest, std::abs(system.view().x().data()[i]));
    }
    return std::max(asked, 8 * value_epsilon(system.view().precision()) * largest);
  }

  // E is another one: its minimum is looked for by what is left of the iterations.
  void begin_anew(int iteration) {
    collapsed_ = 0;
    crawl_.reset();
    if (iteration + 1 < options_.max_iterations) error_.reset();
  }

  // Whether a step whose estimated error is below the tolerance (m) ends with what was taken of its last direction. The
  // estimate is that of the whole direction; a part of one that is below the tolerance will do too. Of a body at rest without
  // a force, E is rounding and so is the direction: a part of it that lowers E where the whole does not was found by noise,
  // and the next one would be too.
  bool is_enough(const IterationReport& report, bool moved, double tolerance) const {
    const bool whole = moved && (report.alpha == 1 || search_.truncated() || search_.bound() < 1);
    if (!whole && search_.bound() >= collapsed_step && report.dx_beyond_m == 0)
      return true;  // nothing is left
    const bool enough = (report.alpha == 1 && !search_.truncated()) || report.dx_inf_m < tolerance;
    return enough && (report.contraction.finite() || as_modelled(report));
  }

  // Whether E has changed along the step as its quadratic model says, or by noise. Where the rate of convergence
  // is not known a short direction shows nothing without it: a gap far below its equilibrium under an unbounded
  // barrier doubles with every iteration, by directions as short as the gap. Requires that energies were compared.
  bool as_modelled(const IterationReport& report) const {
    constexpr double tolerance = 0.25;
    const double modelled = -report.alpha * (2 - report.alpha) * report.decrement_J;
    if (report.alpha == 0) return report.decrement_J == 0;
    return search_.noise() ||
           std::abs(report.energy_change_J.value - modelled) <= tolerance * std::abs(modelled);
  }

  // The step, dt s long, ends in the minimum of E.
  void end_in_minimum(StepReport& step, const EndCheck& end, const IterationReport& last, double dt) const {
    end_converged(step, end, last.error_estimate_m.value + left_of(last), options_.tol_velocity * dt);
  }

  // Whether no part of a direction that is free to be taken was: E falls nowhere along it, or no trial is feasible.
  bool falls_nowhere(bool moved) const { return !moved && search_.bound() >= collapsed_step; }

  // Before a step fails by that, the whole secant is requested. Returns whether another iteration follows, whose matrix has
  // more of it than this one. last: none can follow.
  bool turn_to_secant(StepSystem& system, bool moved, bool at_pose, bool last) {
    if (!at_pose || last || !falls_nowhere(moved)) return false;
    return secant_.took(true, system);
  }

  // Whether the step ends short of it, which it then says: E falls nowhere along a direction that is free to be taken, or
  // next to nothing was taken of collapse_iterations directions in a row.
  bool gives_up(const StepSystem& system, const StepTask& task, const IterationReport& last, bool moved,
                bool at_pose, StepReport& step) {
    if (falls_nowhere(moved)) {
      step.status = StepStatus::line_search_failed;
      return true;
    }
    collapsed_ = in_a_row(collapsed_, last.alpha < collapsed_step);
    if (collapsed_ != collapse_iterations) return false;
    step.status = at_pose ? StepStatus::step_collapse : StepStatus::pin_infeasible;
    step.detail = at_pose ? describe_bound(system) : describe_short_pin(system, task);
    return true;
  }

  // The step ends by the cap of iterations.
  void end_at_cap(StepReport& step) const {
    step.still_falling = error_.still_falling();
    step.detail = fmt::format("|dx| {:.3g} m, {}", error_.last(),
                              step.still_falling ? "still falling" : "no longer falling");
  }

  StepSolverOptions options_;
  StepSearch search_;
  double gradient_tolerance_;  // N, 0: none
  bool level_ = false;         // the gradient of the iterate is below it
  std::function<bool(StepSystem&)> after_motion_;
  ErrorEstimate error_;
  CrawlWatch crawl_;
  SecantRule secant_;
  double* secants_ = nullptr;  // iterations of the step with a share of the secant
  int collapsed_ = 0;          // steps in a row
  int escapes_ = 0;            // of the step
};

}  // namespace

std::unique_ptr<StepSolver> make_line_search(const StepSolverOptions& options, const LineSearchRules& rules) {
  return std::make_unique<LineSearch>(options, rules);
}

StepSolverEntry step_solver_line_search() {
  StepSolverEntry entry;
  entry.guarantee =
      "no surface passes through another and no strain reaches its limit, in the motion of any iteration; a "
      "step that does not "
      "converge ends the run";
  entry.parameters = {
      {"armijo", open_high(open_low(number_in(0, 0.5, "1"))), 1e-4, "sufficient decrease"},
      {"cap_fraction", open_low(number_in(0, 1, "1")), 0.8,
       "part of a binding contact or strain bound that is taken; 1 goes to the stop level"},
  };
  entry.counters = {
      {"feasibility_trials",
       "line_search: those of line_search_trials that feasibility alone judged, short of a pose",
       OverSteps::sum},
      {"truncations",
       "line_search: iterations in which vertices went each as far as contact let it (/contact/step_bound)",
       OverSteps::sum},
      {"lengthened", "line_search: iterations in which dx was taken more than once, since steps crawled",
       OverSteps::sum},
      {"secants", "line_search: iterations with a share of the secant of friction (/friction/hessian)",
       OverSteps::sum}};
  entry.settings.vertex_steps = true;
  entry.make = [](const StepSolverOptions& options) {
    return make_line_search(options, {number(options.parameters, "cap_fraction"), true});
  };
  return entry;
}

}  // namespace bb
