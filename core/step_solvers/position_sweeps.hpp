// Steps that move positions by one constraint after the other: what XPBD and projection share. From where inertia and loads
// alone lead, all constraints that the terms offer are swept over in one order, contact found anew before each sweep. A
// rule states how far a constraint moves its vertices along W grad C, W = h^2/m.
#pragma once

#include <vector>

#include "core/newton/constraint_system.hpp"
#include "core/newton/step_solver.hpp"

namespace bb {

class ConstraintRule {
 public:
  virtual ~ConstraintRule() = default;
  /// What is added to sum W |grad C|^2, unit of `compliance`.
  virtual double softness(double compliance) const = 0;
  /// dx = W grad C times it, N for C in m. sum: sum W |grad C|^2 + softness. multiplier: what this constraint was given in the
  /// sweeps before, 0 at first; the rule adds to it what it wants to keep.
  virtual double change(ConstraintKind kind, double value, double compliance, double sum,
                        double& multiplier) const = 0;
};

class PositionSweeps {
 public:
  /// What the last sweep did.
  struct Last {
    double correction_m = 0;  // largest |change| sum of a constraint
    double constraints = 0;
  };
  /// Largest |C| of an equality, largest -C of an inequality, m, all contacts found anew there.
  struct Left {
    double equality_m = 0, overlap_m = 0;
  };

  /// Errors: ConfigError for what cannot be stepped so, with the name of the step solver.
  static void require(StepSystem& system, std::string_view solver);
  /// Starts the step and sweeps; the state is left in here.
  StepReport sweep(StepSystem& system, const StepTask& task, Prediction& used, const ConstraintRule& rule,
                   int sweeps);
  const Last& last() const { return last_; }
  /// Of the state after the sweeps. Cost: contact found once, all constraints evaluated.
  Left left(StepSystem& system);
  /// That state becomes that of the step, whatever it went through.
  void end_there(StepSystem& system, StepReport& step, StepObserver& observer);

 private:
  void carry_over(const std::vector<const ConstraintBatch*>& batches);
  double solve(const ConstraintBatch& batch, const ConstraintRule& rule, std::vector<double>& multipliers);

  ConstraintSystem::FreeMotion state_;
  Last last_;
  std::vector<std::vector<double>> multipliers_;  // N, of every batch
  std::vector<double> before_;                    // those of one batch in the sweep before
  std::vector<double> gradient_;                  // of one constraint
};

}  // namespace bb
