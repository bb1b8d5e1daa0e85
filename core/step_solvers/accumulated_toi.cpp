// One time step after Ando 2024 (A Cubic Barrier with Elasticity-Inclusive Dynamic Stiffness): no energy of a trial is
// requested, feasibility alone limits the step. Newton iterations on the same x_tilde accumulate the fraction
// of the motion that was feasible, beta; once beta >= target the step is shortened to beta dt and one more
// iteration with the shortened prediction reduces the error. Only with implicit Euler, whose prediction
// scales with dt.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "core/newton/iteration.hpp"
#include "core/newton/step_solver.hpp"

namespace bb {
namespace {

constexpr double extension = 1.25;  // a full step must be free along this multiple of itself

/// How far a vertex may go in one iteration where the config gives no length, m: the diagonal of the box that holds the start of the
/// step, where it leads without contact, and the poses of prescribed vertices. It grows and shrinks with the scene.
double longest_way(const Scene& scene, const StepTask& task, const Positions& x_tilde) {
  const Positions& x = task.history->x;
  const double fall = largest_gravity(scene.gravity, scene.gravity_keys) * task.dt * task.dt;
  Positions posed = x;
  task.pose(task.dt, posed);
  Vec3d low = x.rowwise().minCoeff(), high = x.rowwise().maxCoeff();
  for (const Positions* other : {&x_tilde, static_cast<const Positions*>(&posed)}) {
    low = low.cwiseMin(other->rowwise().minCoeff());
    high = high.cwiseMax(other->rowwise().maxCoeff());
  }
  const double diagonal = (high - low).norm() + fall;
  return diagonal > 0 ? diagonal : std::numeric_limits<double>::infinity();
}

class AccumulatedToi final : public StepSolver {
 public:
  explicit AccumulatedToi(const StepSolverOptions& options)
      : options_(options),
        target_toi_(number(options.parameters, "target_toi")),
        min_newton_steps_(integer(options.parameters, "min_newton_steps")),
        given_way_(optional_number(options.parameters, "max_dx_m")) {}
  std::string_view name() const override { return "accumulated_toi"; }

  StepReport advance(StepSystem& system, const StepTask& task, Prediction& used,
                     StepObserver& observer) override {
    StepReport step = start_step(system, task, used);
    longest_way_ = given_way_ ? *given_way_ : longest_way(system.view().scene(), task, used.x_tilde);
    step.dt_s = 0;  // until a part of it is reached
    double &beta = step.solver.values["toi"] = 0, &iterations = step.solver.values["toi_iterations"] = 0;
    for (int iteration = 0; iteration < options_.max_iterations; ++iteration) {
      const double advanced = iterate(system, step, task.step, iteration, SaddleRule::ignore, observer);
      if (step.status != StepStatus::iteration_cap) return step;
      beta += std::max(0.0, 1.0 - beta) * advanced;
      ++iterations;
      if (beta >= target_toi_ && iteration + 1 >= min_newton_steps_) {
        step.dt_s = beta * task.dt;
        reduce_error(system, step, task, used, iteration + 1, observer);
        return step;
      }
    }
    step.dt_s = beta * task.dt;
    return step;
  }

 private:
  // One assemble, solve, bound, move. Returns the fraction of the Newton direction that was taken. rule: whether the
  // matrix of the iterate is looked at.
  double iterate(StepSystem& system, StepReport& step, int step_index, int iteration, SaddleRule rule,
                 StepObserver& observer) {
    IterationReport report = begin_iteration(system, step_index, iteration);
    find_direction(system, report, observer);
    if (const auto failed = direction_failure(report, false)) {
      fail_step(system, step, *failed, report);
      finish_iteration(system, step, report, observer);
      return 0;
    }
    step.end_proof = check_end(system, rule, step, report).proof;
    const double largest = system.direction_size().vertex_m;
    const double scale = largest > longest_way_ ? longest_way_ / largest : 1.0;
    system.scale_direction(scale);
    const double alpha = feasible_step(system, report);
    report.alpha = scale * alpha;
    const bool moved = alpha > 0;
    if (moved) {
      system.accept();
      report.energy_change_J = Number::missing(no_energies_compared);
    }
    finish_iteration(system, step, report, observer);
    if (moved) {
      show_motion(system, step_index, observer);
    } else {
      step.status = system.view().at_target() ? StepStatus::step_collapse : StepStatus::pin_infeasible;
      step.detail = describe_bound(system);
    }
    return report.alpha;
  }

  // Bounds `extension` times the motion and takes that fraction of the motion itself, which backs
  // off from contact.
  double feasible_step(StepSystem& system, IterationReport& report) {
    system.scale_direction(extension);
    system.prepare_motion(MotionEnd::free, true);
    double alpha = system.bound_motion(report);
    for (; alpha > 0; alpha = alpha < 1e-14 ? 0 : alpha / 2) {
      ++report.line_search_trials;
      if (system.try_feasible(alpha / extension)) break;
    }
    return alpha;
  }

  // The last pass: the prediction belongs to the time that was reached.
  void reduce_error(StepSystem& system, StepReport& step, const StepTask& task, Prediction& used,
                    int iteration, StepObserver& observer) {
    {
      const ScopedPhase timer(system.clock(), Phase::prediction);
      task.integrator->predict(*task.history, step.dt_s, used);
      used.t_end = task.history->t + step.dt_s;
      system.restart_step(used, step.dt_s);
      aim_at_poses(system, task, step.dt_s);
    }
    step.status = StepStatus::converged;
    iterate(system, step, task.step, iteration, options_.saddle, observer);
  }

  StepSolverOptions options_;
  double target_toi_;
  int min_newton_steps_;
  std::optional<double> given_way_;  // m
  double longest_way_ = 0;           // m, of the step
};

std::optional<Violation> too_many_newton_steps(const ParameterMap& parameters, int max_iterations) {
  const int least = integer(parameters, "min_newton_steps");
  if (least <= max_iterations) return std::nullopt;
  return Violation{"min_newton_steps", fmt::format("{}", least),
                   fmt::format("an integer <= max_iterations = {}", max_iterations)};
}

}  // namespace

StepSolverEntry step_solver_accumulated_toi() {
  StepSolverEntry entry;
  entry.guarantee =
      "no surface passes through another and no strain reaches its limit, in the motion of any iteration; "
      "how far its end is "
      "from the solution is not computed, and a step may cover a part of dt alone";
  entry.parameters = {
      {"target_toi", open_low(number_in(0, 1, "1")), 0.25, "accumulated time of impact that ends the step"},
      {"min_newton_steps", count(1, 1000000), 1, "smallest number of iterations"},
      {"max_dx_m", computed(positive("m"), "the diagonal of the box of the scene and of its way in the step"),
       no_default,
       "longest way of a vertex in one iteration; a longer direction is shortened, and what was cut off "
       "counts as not "
       "advanced (1 m in the code of Ando 2024)"},
  };
  entry.counters = {
      {"toi", "accumulated_toi: time of impact that a step accumulates, as a part of its dt",
       OverSteps::smallest},
      {"toi_iterations", "accumulated_toi: iterations before the one that reduces the error", OverSteps::sum},
  };
  entry.needs.energies = entry.needs.minimum = false;
  entry.asked_to_converge = false;
  entry.settings.implicit_euler = true;
  entry.settings.contradiction = too_many_newton_steps;
  entry.make = [](const StepSolverOptions& options) -> std::unique_ptr<StepSolver> {
    return std::make_unique<AccumulatedToi>(options);
  };
  return entry;
}

}  // namespace bb
