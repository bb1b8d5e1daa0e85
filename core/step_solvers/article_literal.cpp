// One time step as the article "The Polynomial That Fixed 30 Years of Cloth Simulation" computes it: the
// protocol that its figure is reproduced with, never one of a comparison. Newton with a Tikhonov term, Armijo
// backtracking, and nothing that keeps a step free of contact or within the strain limit; the barriers are
// evaluated past both (BarrierFunction::literal). What that hides, the audit finds.

#include "core/newton/iteration.hpp"
#include "core/newton/step_solver.hpp"

namespace bb {
namespace {

constexpr double tikhonov_relative = 1e-6, tikhonov_absolute = 1e-8;
constexpr double smallest_trial = 1e-8;

class ArticleLiteral final : public StepSolver {
 public:
  explicit ArticleLiteral(const StepSolverOptions& options)
      : options_(options), armijo_(number(options.parameters, "armijo")) {}
  std::string_view name() const override { return "article_literal"; }

  StepReport advance(StepSystem& system, const StepTask& task, Prediction& used,
                     StepObserver& observer) override {
    StepReport step = start_step(system, task, used);
    for (int iteration = 0; iteration < options_.max_iterations; ++iteration) {
      IterationReport report = begin_iteration(system, task.step, iteration);
      system.add_tikhonov(tikhonov_relative, tikhonov_absolute);
      find_direction(system, report, observer);
      const bool small = report.dx_inf_m / task.dt < options_.tol_velocity;
      if (const auto failed = direction_failure(report, !small)) {
        finish_iteration(system, step, report, observer);
        fail_step(system, step, *failed, report);
        return step;
      }
      const EndCheck end = small ? check_end(system, options_.saddle, step, report) : EndCheck();
      const bool moved = backtrack(system, report);
      finish_iteration(system, step, report, observer);
      if (moved) show_motion(system, task.step, observer);
      if (small) end_converged(step, end, Number::missing("not_estimated"), 0);
      if (!small && !moved) step.status = StepStatus::line_search_failed;
      if (small || !moved) return step;
    }
    return step;
  }

 private:
  bool backtrack(StepSystem& system, IterationReport& report) {
    system.prepare_motion(MotionEnd::free, false);
    for (double alpha = 1; alpha > smallest_trial; alpha /= 2) {
      ++report.line_search_trials;
      const auto change = system.try_motion(alpha);
      if (!change) continue;
      const bool decrease = change->change <= -armijo_ * alpha * (2 * report.decrement_J);
      report.rounding_accepts = !decrease && within_rounding(*change, system.view().precision());
      if (!decrease && !report.rounding_accepts) continue;
      report.alpha = alpha;
      report.energy_change_J = change->change;
      system.accept();
      return true;
    }
    return false;
  }

  StepSolverOptions options_;
  double armijo_;
};

}  // namespace

StepSolverEntry step_solver_article_literal() {
  StepSolverEntry entry;
  entry.guarantee = "none: nothing keeps a step from passing through a surface or beyond the strain limit";
  entry.parameters = {{"armijo", open_high(open_low(number_in(0, 0.5, "1"))), 1e-4, "sufficient decrease"}};
  entry.needs.minimum = entry.needs.step_bound = false;
  entry.settings = {.implicit_euler = true, .clamped = true, .protocol = "article_literal"};
  entry.make = [](const StepSolverOptions& options) -> std::unique_ptr<StepSolver> {
    return std::make_unique<ArticleLiteral>(options);
  };
  return entry;
}

}  // namespace bb
