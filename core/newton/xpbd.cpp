// One time step by extended position-based dynamics (Macklin, Mueller, Chentanez 2016, XPBD: Position-Based Simulation of
// Compliant Constrained Dynamics): from where inertia and loads alone lead, one constraint after the other is solved, in
// one order, a given number of times over all of them. With lambda a force and W = h^2/m, theirs with lambda/h^2 and
// compliance/h^2:
//
//   dlambda = -(C + compliance lambda)/(sum W |grad C|^2 + compliance),   dx = W grad C dlambda
//
// Where nothing changes any more, C = -compliance lambda. That is the implicit Euler step of the energies C^2/(2 compliance) as
// far as gradients do not turn within the step: a change acts along the gradient of its moment. Contact is C = d >= 0
// without compliance: the barrier is not felt, and nothing keeps a step from passing through a surface. Newton matrices,
// step bound and energies are not asked for. max_iterations is the number of sweeps.
#include <algorithm>
#include <cmath>

#include "core/math/error.hpp"
#include "core/newton/constraint_system.hpp"
#include "core/newton/iteration.hpp"
#include "core/newton/newton_system.hpp"
#include "core/newton/step_solver.hpp"

namespace bb {
namespace {

class Xpbd final : public StepSolver {
 public:
  explicit Xpbd(const StepSolverOptions& options) : options_(options) {}
  std::string_view name() const override { return "xpbd"; }

  void require(StepSystem& system) const override {
    if (!system.is_on_host())
      throw ConfigError("/device", "one beside the processor", "cpu: the step solver is xpbd");
    system.on_host().constraints().require_constraints();
  }

  StepReport advance(StepSystem& system, const StepTask& task, Prediction& used,
                     StepObserver& observer) override {
    StepReport step = start_step(system, task, used);
    ConstraintSystem& constraints = system.on_host().constraints();
    Positions given = task.history->x;
    task.pose(task.dt, given);
    state_ = constraints.free_motion(given);
    multipliers_.clear();
    double correction = 0, count = 0;
    for (int sweep = 0; sweep < options_.max_iterations; ++sweep) {
      const auto& batches = constraints.find(state_.x, Inequalities::rigid);
      carry_over(batches);
      correction = count = 0;
      for (std::size_t b = 0; b < batches.size(); ++b) {
        correction = std::max(correction, solve(*batches[b], multipliers_[b]));
        count += static_cast<double>(batches[b]->size());
      }
      if (!state_.x.allFinite()) break;
    }
    step.solver.values = {{"xpbd_constraints", count},
                          {"xpbd_correction_m", correction},
                          {"xpbd_sweeps", static_cast<double>(options_.max_iterations)}};
    end_there(system, step, observer);
    return step;
  }

 private:
  // Of constraints that come and go those of the ones that stay.
  void carry_over(const std::vector<const ConstraintBatch*>& batches) {
    multipliers_.resize(batches.size());
    for (std::size_t b = 0; b < batches.size(); ++b) {
      before_.swap(multipliers_[b]);
      multipliers_[b].assign(batches[b]->size(), 0.0);
      for (std::size_t e = 0; e < multipliers_[b].size() && !before_.empty(); ++e) {
        const std::ptrdiff_t was = batches[b]->before(e);
        if (was >= 0) multipliers_[b][e] = before_[static_cast<std::size_t>(was)];
      }
    }
  }

  // One sweep over the constraints of a batch. Returns the largest |C + compliance lambda| that was corrected, m.
  double solve(const ConstraintBatch& batch, std::vector<double>& multipliers) {
    gradient_.resize(3 * static_cast<std::size_t>(batch.width()));
    double largest = 0;
    for (std::size_t e = 0; e < batch.size(); ++e) {
      const double value = batch.value(e, state_.x, gradient_.data()), compliance = batch.compliance()[e];
      double sum = compliance;
      for_each_number(batch, e, [&](std::size_t k, Eigen::Index at) {
        sum += state_.inverse.data()[at] * gradient_[k] * gradient_[k];
      });
      if (!(sum > 0) || std::isinf(compliance)) continue;  // nothing of it can move
      double& multiplier = multipliers[e];
      double change = -(value + compliance * multiplier) / sum;
      if (batch.kind() == ConstraintKind::inequality) change = std::max(change, -multiplier);
      multiplier += change;
      for_each_number(batch, e, [&](std::size_t k, Eigen::Index at) {
        state_.x.data()[at] += state_.inverse.data()[at] * gradient_[k] * change;
      });
      largest = std::max(largest, std::abs(change) * sum);
    }
    return largest;
  }

  // f(k, at): entry k of the gradient belongs to number `at` of the positions.
  template <class F>
  static void for_each_number(const ConstraintBatch& batch, std::size_t e, const F& f) {
    const auto width = static_cast<std::size_t>(batch.width());
    for (std::size_t a = 0; a < width; ++a) {
      const int vertex = batch.vertices()[width * e + a];
      for (std::size_t k = 0; vertex >= 0 && k < 3; ++k)
        f(3 * a + k, 3 * Eigen::Index{vertex} + static_cast<Eigen::Index>(k));
    }
  }

  // The state of the sweeps becomes that of the step, whatever it went through.
  void end_there(StepSystem& system, StepReport& step, StepObserver& observer) {
    NewtonSystem& host = system.on_host();
    host.set_direction(state_.x - system.view().x());
    system.prepare_motion(MotionEnd::on_target, false);
    if (!system.try_feasible(1)) {
      step.status = StepStatus::non_finite;
      step.detail = "the state after the last sweep";
      return;
    }
    system.accept();
    show_motion(system, step.step, observer);
    step.status = StepStatus::converged;
  }

  StepSolverOptions options_;
  ConstraintSystem::FreeMotion state_;
  std::vector<std::vector<double>> multipliers_;  // N, of every batch
  std::vector<double> before_;                    // those of one batch in the sweep before
  std::vector<double> gradient_;                  // of one constraint
};

}  // namespace

StepSolverEntry step_solver_xpbd() {
  StepSolverEntry entry;
  entry.counters = {
      {"xpbd_sweeps", "xpbd: sweeps over all constraints", OverSteps::sum},
      {"xpbd_constraints", "xpbd: constraints in the last sweep of a step", OverSteps::largest},
      {"xpbd_correction_m", "xpbd: largest |C + compliance lambda| that the last sweep of a step corrected",
       OverSteps::largest},
  };
  entry.needs = {.matrix = false, .energies = false, .minimum = false, .step_bound = false};
  entry.asked_to_converge = false;
  entry.make = [](const StepSolverOptions& options) -> std::unique_ptr<StepSolver> {
    return std::make_unique<Xpbd>(options);
  };
  return entry;
}

}  // namespace bb
