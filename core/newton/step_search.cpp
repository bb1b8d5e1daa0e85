#include "core/newton/step_search.hpp"

#include <algorithm>

#include "core/newton/iteration.hpp"

namespace bb {
namespace {

constexpr double smallest_alpha = 1e-14;  // below it x does not move any more

}  // namespace

void StepSearch::begin_step(StepReport& step) {
  feasibility_trials_ = &(step.solver.values["feasibility_trials"] = 0);
  truncations_ = &(step.solver.values["truncations"] = 0);
  lengthened_ = &(step.solver.values["lengthened"] = 0);
}

bool StepSearch::out_of_saddle(StepSystem& system, EndProof proof, IterationReport& report,
                               double tolerance) {
  const std::vector<double>& d_hat = system.view().scene().d_hat;
  const double widest = d_hat.empty() ? 0 : *std::max_element(d_hat.begin(), d_hat.end());
  const double length = std::max(widest, 2 * tolerance);
  const WholePhase timer(system.clock(), Phase::end_check);
  system.aim_at_escape(length);
  const double slope = std::min(0.0, system.direction_size().slope_J),
               curvature = proof == EndProof::cusp ? 0 : system.direction_curvature();
  if ((curvature < 0 || proof == EndProof::cusp) &&
      leave(system, report, slope, curvature, tolerance / length))
    return true;
  system.restore_direction();
  return false;
}

// Lengths are parts of that of the escape.
bool StepSearch::leave(StepSystem& system, IterationReport& report, double slope, double curvature,
                       double least) {
  find_bound(system, report);
  for (double alpha = bound_ < 1 ? cap_fraction_ * bound_ : 1; alpha > least; alpha /= 2) {
    ++report.line_search_trials;
    const auto change = system.try_motion(alpha);
    const double modelled = alpha * slope + alpha * alpha * curvature / 2;
    if (!change || change->change > armijo_ * modelled || within_rounding(*change, system.view().precision()))
      continue;
    report.alpha = alpha;
    report.energy_change_J = change->change;
    report.escapes = 1;
    system.accept();
    return true;
  }
  return false;
}

// Along a longer dx, halved as long as that is longer than dx itself. Bounds are fractions of dx, which nothing ends.
bool StepSearch::go_far(StepSystem& system, IterationReport& report, double length) {
  const double ccd = report.alpha_ccd, strain = report.alpha_strain;
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

bool StepSearch::along_direction(StepSystem& system, IterationReport& report, bool energy_test, bool small,
                                 double length) {
  find_bound(system, report);
  share_ = 1, truncated_ = shortened_ = false, taken_ = 0;
  if (length > 1 && energy_test && !small && bound_ == 1 && go_far(system, report, length)) return true;
  if (bounded_ && report.alpha_ccd < 1) {
    if (const auto motion = system.truncate_motion(report))
      return go_truncated(system, report, *motion, energy_test);
  }
  const bool held = bound_ < 1 && report.alpha_ccd <= report.alpha_strain;
  if (held && energy_test && !small && go_round(system, report)) return true;
  return go_along(system, report, smallest_alpha, energy_test);
}

// Without a step bound every trial is one of states alone.
void StepSearch::find_bound(StepSystem& system, IterationReport& report) {
  system.prepare_motion(MotionEnd::on_target, bounded_);
  bound_ = bounded_ ? system.bound_motion(report) : 1;
}

// A gap that is curved along dx, as that of an edge that rolls over a ball, ends a straight step after the root of what
// is left of it, however soft the barrier is. Such a step presses the gap together, the next one as well, and from
// then on every one wins no more than the energy of a gap that doubles. A curvature correction, made by a second
// solve, lets the whole direction through. Taken where it goes at least twice as far.
bool StepSearch::go_round(StepSystem& system, IterationReport& report) {
  const double straight = bound_;
  if (!system.correct_curvature(straight, report.solve)) return false;
  bound_again(system, report);
  if (go_along(system, report, 2 * straight, true)) {
    report.detours = 1;
    return true;
  }
  system.restore_direction();
  bound_again(system, report);
  return false;
}

// Each vertex as far as contact lets it, where that wins more of the fall that dx promises to first order than all of them
// would that go as far as the one that may go least: a motion cut unevenly deforms what dx leaves in shape, and where E or
// the strain limit stops it at once, ever shorter parts of it follow while the way for all is open. What is taken is reported
// as the part of that fall; of a motion that compares no energies, as that of prescribed vertices.
bool StepSearch::go_truncated(StepSystem& system, IterationReport& report, const TruncatedMotion& motion,
                              bool energy_test) {
  const double slope = system.direction_size().slope_J, whole = -2 * report.decrement_J;
  if (!energy_test || (slope < 0 && whole < 0)) {
    const double of_all = bound_;
    bound_ = motion.bound;
    share_ = energy_test ? slope / whole : motion.of_pins;
    truncated_ = true;
    const double least = energy_test ? cap_fraction_ * of_all / share_ : 0;
    if (go_along(system, report, std::max(smallest_alpha, least), energy_test)) {
      ++*truncations_;
      return true;
    }
    bound_ = of_all;
  }
  share_ = 1, truncated_ = false;
  system.restore_direction();
  bound_again(system, report);
  return go_along(system, report, smallest_alpha, energy_test);
}

// Of another dx; the queries of both count.
void StepSearch::bound_again(StepSystem& system, IterationReport& report) {
  const StepBound before = report.bound;
  find_bound(system, report);
  report.bound.queries += before.queries;
  report.bound.probes += before.probes;
  report.bound.capped += before.capped;
  report.bound.zero += before.zero;
}

bool StepSearch::go_along(StepSystem& system, IterationReport& report, double least, bool energy_test) {
  // A step all the way to the stop level would leave a gap that takes a dozen iterations to open again.
  double alpha = bound_;
  if (alpha < 1) alpha *= cap_fraction_;
  const double longest = alpha;
  for (; alpha > least; alpha /= 2) {
    ++report.line_search_trials;
    if (!(energy_test ? decreases(system, report, alpha) : is_feasible(system, report, alpha))) continue;
    taken_ = alpha * share_;
    shortened_ = energy_test && alpha < longest && !noise_;
    report.alpha = std::min(1.0, taken_);
    system.accept();
    return true;
  }
  return false;
}

bool StepSearch::decreases(StepSystem& system, IterationReport& report, double alpha) {
  const auto change = system.try_motion(alpha);
  if (!change) return false;
  const bool decrease = change->change <= -armijo_ * (alpha * share_) * (2 * report.decrement_J);
  noise_ = within_rounding(*change, system.view().precision());
  report.rounding_accepts = !decrease && noise_;
  if (!decrease && !noise_) return false;
  report.energy_change_J = change->change;
  return true;
}

bool StepSearch::is_feasible(StepSystem& system, IterationReport& report, double alpha) {
  ++*feasibility_trials_;
  if (!system.try_feasible(alpha)) return false;
  report.energy_change_J = Number::missing(no_energies_compared);
  return true;
}

}  // namespace bb
