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
// step bound and energies are not requested. max_iterations is the number of sweeps.
#include <algorithm>

#include "core/step_solvers/position_sweeps.hpp"

namespace bb {
namespace {

class Compliant final : public ConstraintRule {
 public:
  double softness(double compliance) const override { return compliance; }
  double change(ConstraintKind kind, double value, double compliance, double sum,
                double& multiplier) const override {
    double change = -(value + compliance * multiplier) / sum;
    if (kind == ConstraintKind::inequality) change = std::max(change, -multiplier);
    multiplier += change;
    return change;
  }
};

class Xpbd final : public StepSolver {
 public:
  explicit Xpbd(const StepSolverOptions& options) : options_(options) {}
  std::string_view name() const override { return "xpbd"; }
  void require(StepSystem& system) const override { PositionSweeps::require(system, name()); }

  StepReport advance(StepSystem& system, const StepTask& task, Prediction& used,
                     StepObserver& observer) override {
    StepReport step = sweeps_.sweep(system, task, used, Compliant(), options_.max_iterations);
    step.solver.values = {{"xpbd_constraints", sweeps_.last().constraints},
                          {"xpbd_correction_m", sweeps_.last().correction_m},
                          {"xpbd_sweeps", static_cast<double>(options_.max_iterations)}};
    sweeps_.end_there(system, step, observer);
    return step;
  }

 private:
  StepSolverOptions options_;
  PositionSweeps sweeps_;
};

}  // namespace

StepSolverEntry step_solver_xpbd() {
  StepSolverEntry entry;
  entry.guarantee =
      "none: nothing keeps a step from passing through a surface, and what the sweeps have not corrected is "
      "left";
  entry.counters = {
      {"xpbd_sweeps", "xpbd: sweeps over all constraints", OverSteps::sum},
      {"xpbd_constraints", "xpbd: constraints in the last sweep of a step", OverSteps::largest},
      {"xpbd_correction_m", "xpbd: largest |C + compliance lambda| that the last sweep of a step corrected",
       OverSteps::largest},
  };
  entry.needs = {.matrix = false, .energies = false, .minimum = false, .step_bound = false};
  entry.settings.implicit_euler = true;
  entry.asked_to_converge = false;
  entry.has_forces = false;
  entry.make = [](const StepSolverOptions& options) -> std::unique_ptr<StepSolver> {
    return std::make_unique<Xpbd>(options);
  };
  return entry;
}

}  // namespace bb
