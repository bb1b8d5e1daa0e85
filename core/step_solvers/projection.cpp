// One time step by position-based dynamics (Mueller, Heidelberger, Hennix, Ratcliff 2007, Position Based Dynamics): the
// sweeps of xpbd with constraints that have no compliance and no memory,
//
//   dx = -s C W grad C/sum W |grad C|^2,   s = 1 - (1 - k)^(1/n)
//
// for springs, with their stiffness k in (0, 1] and n sweeps, so that the part (1 - k) of a lone C is left after all of
// them (their section 3.3), and s = 1 for contact, where C < 0 alone acts. What a spring resists by goes with k, n, dt and
// the mesh, not with its N/m. Contact is found before every sweep; theirs is found once a step.
#include <cmath>

#include "core/step_solvers/position_sweeps.hpp"

namespace bb {
namespace {

class Rigid final : public ConstraintRule {
 public:
  Rigid(double stiffness, int sweeps) : share_(1 - std::pow(1 - stiffness, 1.0 / sweeps)) {}
  double softness(double) const override { return 0; }
  double change(ConstraintKind kind, double value, double, double sum, double&) const override {
    if (kind == ConstraintKind::equality) return -share_ * value / sum;
    return value < 0 ? -value / sum : 0;
  }

 private:
  double share_;
};

class ProjectionSteps final : public StepSolver {
 public:
  explicit ProjectionSteps(const StepSolverOptions& options)
      : sweeps_per_step_(options.max_iterations),
        rule_(number(options.parameters, "projection_stiffness"), options.max_iterations) {}
  std::string_view name() const override { return "projection"; }
  void require(StepSystem& system) const override { PositionSweeps::require(system, name()); }

  StepReport advance(StepSystem& system, const StepTask& task, Prediction& used,
                     StepObserver& observer) override {
    StepReport step = sweeps_.sweep(system, task, used, rule_, sweeps_per_step_);
    const PositionSweeps::Left left = sweeps_.left(system);
    step.solver.values = {{"projection_constraints", sweeps_.last().constraints},
                          {"projection_stretch_m", left.equality_m},
                          {"projection_overlap_m", left.overlap_m},
                          {"projection_sweeps", static_cast<double>(sweeps_per_step_)}};
    sweeps_.end_there(system, step, observer);
    return step;
  }

 private:
  int sweeps_per_step_;
  Rigid rule_;
  PositionSweeps sweeps_;
};

}  // namespace

StepSolverEntry step_solver_projection() {
  StepSolverEntry entry;
  entry.guarantee =
      "none: nothing keeps a step from passing through a surface; springs resist by the number of sweeps, dt "
      "and the mesh, not by "
      "their stiffness";
  entry.parameters = {{"projection_stiffness", open_low(number_in(0, 1, "1")), 1.0,
                       "projection: part of the elongation of a lone spring that the max_iterations sweeps "
                       "of a step take off"}};
  entry.stated_always = false;
  entry.counters = {
      {"projection_sweeps", "projection: sweeps over all constraints", OverSteps::sum},
      {"projection_constraints", "projection: constraints in the last sweep of a step", OverSteps::largest},
      {"projection_stretch_m", "projection: largest |l - l0| of a spring that is left at the end of a step",
       OverSteps::largest},
      {"projection_overlap_m", "projection: largest -d of a contact that is left at the end of a step",
       OverSteps::largest},
  };
  entry.needs = {.matrix = false, .energies = false, .minimum = false, .step_bound = false};
  entry.settings.implicit_euler = true;
  entry.settings.own_stiffness = true;
  entry.asked_to_converge = false;
  entry.has_forces = false;
  entry.make = [](const StepSolverOptions& options) -> std::unique_ptr<StepSolver> {
    return std::make_unique<ProjectionSteps>(options);
  };
  return entry;
}

}  // namespace bb
