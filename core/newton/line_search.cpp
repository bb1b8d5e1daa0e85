// One time step by Newton's method. Read this file first: it is the whole method.
//
//   1 assemble gradient and Hessian at x, kappa refreshed by its policy
//   2 solve A dx = -g, prescribed motion lifted to the right-hand side; A is the Hessian, as near to the exact
//     one as positive definiteness allows
//   3 stop when the estimated error of x + dx is below h tol_velocity, every prescribed vertex is at its pose
//     and the exact Hessian is positive definite; from a saddle go on along negative curvature
//   4 bound the step: ACCD over all pairs, strain limit; cap_fraction of a bound that binds. Where contact bounds each
//     vertex by itself, dx of each is cut to what it may go, as long as that descends
//   5 Armijo on E, kappa frozen; every trial state is re-checked as rounded; where curved gaps hold the step, first
//     with a detour round them; where steps crawl, first along a longer dx
//   6 accept; what converged goes on where terms renew what they lag

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/newton/crawl_watch.hpp"
#include "core/newton/error_estimate.hpp"
#include "core/newton/iteration.hpp"
#include "core/newton/line_search.hpp"

namespace bb {
namespace {

constexpr double collapsed_step = 1e-8;   // a step below it counts as no progress
constexpr int collapse_iterations = 10;   // that many in a row end the step
constexpr double smallest_alpha = 1e-14;  // below it x does not move any more
constexpr int most_escapes = 10;          // in a step; a saddle after that many is said to be one

class LineSearch final : public StepSolver {
 public:
  LineSearch(const StepSolverOptions& options, const LineSearchRules& rules)
      : options_(options),
        armijo_(number(options.parameters, "armijo")),
        cap_fraction_(rules.cap_fraction),
        bounded_(rules.bounded),
        renewals_(rules.renewals),
        after_motion_(rules.after_motion) {}
  std::string_view name() const override { return options_.name; }

  StepReport advance(StepSystem& system, const StepTask& task, Prediction& used,
                     StepObserver& observer) override {
    StepReport step = start_step(system, task, used);
    feasibility_trials_ = &(step.solver.values["feasibility_trials"] = 0);
    truncations_ = &(step.solver.values["truncations"] = 0);
    lengthened_ = &(step.solver.values["lengthened"] = 0);
    error_.reset();
    crawl_.begin_step();
    const double tolerance = tolerance_of(system, task.dt);
    int collapsed = 0, escapes = 0;
    for (int iteration = 0; iteration < options_.max_iterations; ++iteration) {
      IterationReport report = begin_iteration(system, task.step, iteration);
      find_direction(system, report, observer);
      const bool at_pose = system.view().at_target();
      const bool small = estimate_error(report) < tolerance && at_pose;
      if (const auto failed = direction_failure(report, at_pose && !small)) {
        finish_iteration(system, step, report, observer);
        fail_step(system, step, *failed, report);
        return step;
      }
      const EndCheck end = small ? check_end(system, options_.saddle, step, report) : EndCheck();
      if (end.proof == EndProof::saddle && options_.saddle == SaddleRule::escape && escapes < most_escapes &&
          escape(system, report, tolerance)) {
        ++escapes;
        error_.took(0);
        crawl_.reset();
        finish_iteration(system, step, report, observer);
        show_motion(system, task.step, observer);
        continue;
      }
      const bool moved = search(system, report, at_pose, small);
      // another direction than dx, or another length of it, says nothing about the rate
      error_.took(report.detours > 0 || truncated_ || taken_ > 1 ? 0 : report.alpha);
      crawl_.took(moved && !truncated_ && !noise_ ? taken_ : 0, report);
      finish_iteration(system, step, report, observer);
      if (moved) show_motion(system, task.step, observer);
      if (moved && after_motion_ && after_motion_(system)) {
        collapsed = 0;
        crawl_.reset();
        if (iteration + 1 < options_.max_iterations) error_.reset();
        continue;
      }
      // the estimate is that of the whole direction; a part of one that is below the tolerance will do too
      const bool enough = (report.alpha == 1 && !truncated_) || report.dx_inf_m < tolerance;
      // Of a body at rest without a force, E is rounding and so is the direction: a part of it that lowers E where the whole
      // does not was found by noise, and the next one would be too.
      const bool whole = moved && (report.alpha == 1 || truncated_ || bound_ < 1);
      const bool nothing_left = !whole && bound_ >= collapsed_step && report.dx_beyond_m == 0;
      if (small && (nothing_left || (enough && (report.contraction.finite() || as_modelled(report))))) {
        if (system.renew_lag()) {
          if (renewals_) ++*renewals_;
          // another minimum is looked for, by what is left of the iterations
          collapsed = 0;
          crawl_.reset();
          if (iteration + 1 < options_.max_iterations) error_.reset();
          continue;
        }
        end_converged(step, end, report.error_estimate_m, options_.tol_velocity * task.dt);
        return step;
      }
      if (!moved && bound_ >= collapsed_step) {
        step.status = StepStatus::line_search_failed;
        return step;
      }
      collapsed = in_a_row(collapsed, report.alpha < collapsed_step);
      if (collapsed == collapse_iterations) {
        step.status = at_pose ? StepStatus::step_collapse : StepStatus::pin_infeasible;
        step.detail = at_pose ? describe_bound(system) : describe_short_pin(system, task);
        return step;
      }
    }
    step.still_falling = error_.still_falling();
    step.detail = fmt::format("|dx| {:.3g} m, {}", error_.last(),
                              step.still_falling ? "still falling" : "no longer falling");
    return step;
  }

 private:
  // Of x + dx, m.
  double estimate_error(IterationReport& report) {
    error_.add(report.dx_beyond_m, report.solve.linear.residual_true, report.dx_rounding_m);
    report.contraction = error_.contraction();
    report.error_estimate_m = error_.error();
    return error_.error();
  }

  // m. In float no step is asked for less than the rounding of the coordinates that are free to move.
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

  // A step along negative curvature, from d_hat down to the tolerance, as far as the bound allows: E has to fall by a
  // part of what slope and curvature promise, and by more than rounding. False where no length does: within rounding
  // E is level there.
  bool escape(StepSystem& system, IterationReport& report, double tolerance) {
    const std::vector<double>& d_hat = system.view().scene().d_hat;
    const double widest = d_hat.empty() ? 0 : *std::max_element(d_hat.begin(), d_hat.end());
    const double length = std::max(widest, 2 * tolerance);
    const WholePhase timer(system.clock(), Phase::end_check);
    system.aim_at_escape(length);
    const double slope = std::min(0.0, system.direction_size().slope_J),
                 curvature = system.direction_curvature();
    if (curvature < 0 && leave(system, report, slope, curvature, tolerance / length)) return true;
    system.restore_direction();
    return false;
  }

  // Lengths are parts of that of the escape.
  bool leave(StepSystem& system, IterationReport& report, double slope, double curvature, double least) {
    find_bound(system, report);
    for (double alpha = bound_ < 1 ? cap_fraction_ * bound_ : 1; alpha > least; alpha /= 2) {
      ++report.line_search_trials;
      const auto change = system.try_motion(alpha);
      const double modelled = alpha * slope + alpha * alpha * curvature / 2;
      if (!change || change->change > armijo_ * modelled ||
          within_rounding(*change, system.view().precision()))
        continue;
      report.alpha = alpha;
      report.energy_change_J = change->change;
      report.escapes = 1;
      system.accept();
      return true;
    }
    return false;
  }

  // Whether E has changed along the step as its quadratic model says, or by noise. Where the rate of convergence
  // is not known a short direction says nothing without it: a gap far below its equilibrium under an unbounded
  // barrier doubles with every iteration, by directions as short as the gap. Requires that energies were compared.
  bool as_modelled(const IterationReport& report) const {
    constexpr double tolerance = 0.25;
    const double modelled = -report.alpha * (2 - report.alpha) * report.decrement_J;
    if (report.alpha == 0) return report.decrement_J == 0;
    return noise_ || std::abs(report.energy_change_J.value - modelled) <= tolerance * std::abs(modelled);
  }

  // Along a longer dx, halved as long as that is longer than dx itself. Bounds are said of dx, which nothing ends.
  bool go_far(StepSystem& system, IterationReport& report) {
    const double length = crawl_.length(), ccd = report.alpha_ccd, strain = report.alpha_strain;
    system.scale_direction(length);
    bound_again(system, report);
    share_ = length;
    if (go_along(system, report, 1 / length, true)) {
      ++*lengthened_;
      report.alpha_ccd = ccd, report.alpha_strain = strain;
      return true;
    }
    share_ = 1;
    system.scale_direction(1 / length);
    bound_again(system, report);
    return false;
  }

  // Steps 4 to 6. Without an energy test while a prescribed vertex is short of its pose: its
  // motion does work.
  bool search(StepSystem& system, IterationReport& report, bool energy_test, bool small) {
    find_bound(system, report);
    share_ = 1, truncated_ = false, taken_ = 0;
    if (crawl_.length() > 1 && energy_test && !small && bound_ == 1 && go_far(system, report)) return true;
    if (bounded_ && report.alpha_ccd < 1) {
      if (const auto motion = system.truncate_motion(report))
        return go_truncated(system, report, *motion, energy_test);
    }
    const bool held = bound_ < 1 && report.alpha_ccd <= report.alpha_strain;
    if (held && energy_test && !small && go_round(system, report)) return true;
    return go_along(system, report, smallest_alpha, energy_test);
  }

  // Without a step bound every trial is one of states alone.
  void find_bound(StepSystem& system, IterationReport& report) {
    system.prepare_motion(MotionEnd::on_target, bounded_);
    bound_ = bounded_ ? system.bound_motion(report) : 1;
  }

  // A gap that is curved along dx, as that of an edge that rolls over a ball, ends a straight step after the root of what
  // is left of it, however soft the barrier is. Such a step presses the gap together, the next one as well, and from
  // then on every one wins no more than the energy of a gap that doubles. Room for the curvature, made by a second
  // solve, lets the whole direction through. Taken where it goes at least twice as far.
  bool go_round(StepSystem& system, IterationReport& report) {
    const double straight = bound_;
    if (!system.make_detour(straight, report.solve)) return false;
    bound_again(system, report);
    if (go_along(system, report, 2 * straight, true)) {
      report.detours = 1;
      return true;
    }
    system.restore_direction();
    bound_again(system, report);
    return false;
  }

  // Each vertex as far as contact lets it, or where that does not descend all of them as far as the one that may go least.
  // What is taken is said as the part of the fall that dx promises to first order; of a motion that is asked for no
  // energies, as that of prescribed vertices.
  bool go_truncated(StepSystem& system, IterationReport& report, const TruncatedMotion& motion,
                    bool energy_test) {
    const double slope = system.direction_size().slope_J, whole = -2 * report.decrement_J;
    if (!energy_test || (slope < 0 && whole < 0)) {
      const double of_all = bound_;
      bound_ = motion.bound;
      share_ = energy_test ? slope / whole : motion.of_pins;
      truncated_ = true;
      ++*truncations_;
      if (go_along(system, report, smallest_alpha, energy_test)) return true;
      bound_ = of_all;
    }
    share_ = 1, truncated_ = false;
    system.restore_direction();
    bound_again(system, report);
    return go_along(system, report, smallest_alpha, energy_test);
  }

  // Of another dx; the queries of both count.
  void bound_again(StepSystem& system, IterationReport& report) {
    const StepBound before = report.bound;
    find_bound(system, report);
    report.bound.queries += before.queries;
    report.bound.probes += before.probes;
    report.bound.capped += before.capped;
    report.bound.zero += before.zero;
  }

  bool go_along(StepSystem& system, IterationReport& report, double least, bool energy_test) {
    // A step all the way to the stop level would leave a gap that takes a dozen iterations to open again.
    double alpha = bound_;
    if (alpha < 1) alpha *= cap_fraction_;
    for (; alpha > least; alpha /= 2) {
      ++report.line_search_trials;
      if (!(energy_test ? decreases(system, report, alpha) : is_feasible(system, report, alpha))) continue;
      taken_ = alpha * share_;
      report.alpha = std::min(1.0, taken_);
      system.accept();
      return true;
    }
    return false;
  }

  bool decreases(StepSystem& system, IterationReport& report, double alpha) {
    const auto change = system.try_motion(alpha);
    if (!change) return false;
    const bool decrease = change->change <= -armijo_ * (alpha * share_) * (2 * report.decrement_J);
    noise_ = within_rounding(*change, system.view().precision());
    report.rounding_accepts = !decrease && noise_;
    if (!decrease && !noise_) return false;
    report.energy_change_J = change->change;
    return true;
  }

  bool is_feasible(StepSystem& system, IterationReport& report, double alpha) {
    ++*feasibility_trials_;
    if (!system.try_feasible(alpha)) return false;
    report.energy_change_J = Number::missing(no_energies_compared);
    return true;
  }

  StepSolverOptions options_;
  double armijo_, cap_fraction_;
  bool bounded_;
  double* renewals_;
  std::function<bool(StepSystem&)> after_motion_;
  double bound_ = 1;    // of the step taken last
  bool noise_ = false;  // its change of E is
  double share_ = 1;    // of the fall that dx promises, in the motion that is tried
  bool truncated_ = false;
  double taken_ = 0;  // the part of dx that was, above 1 of one that was lengthened
  double *feasibility_trials_ = nullptr, *truncations_ = nullptr, *lengthened_ = nullptr;
  ErrorEstimate error_;
  CrawlWatch crawl_;
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
       OverSteps::sum}};
  entry.settings.vertex_steps = true;
  entry.make = [](const StepSolverOptions& options) {
    return make_line_search(options, {number(options.parameters, "cap_fraction"), true});
  };
  return entry;
}

}  // namespace bb
