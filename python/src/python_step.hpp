// One time step as a step solver of Python sees it (barrierbench.Step): the calls of a step solver on a StepSystem, in the
// order that the records need. The object belongs to Python, and arrays that look at it keep it; once the step is over it
// answers no call.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "core/newton/error_estimate.hpp"
#include "core/newton/iteration.hpp"
#include "core/newton/newton_system.hpp"
#include "python/src/bindings.hpp"

namespace bb::python {

class PythonStep {
 public:
  /// Of a step that has begun (start_step) on the host; all must outlive close().
  PythonStep(NewtonSystem& system, const StepTask& task, const StepSolverOptions& options,
             const Prediction& used, StepReport& report, StepObserver& observer);

  // --- the step
  int index() const { return index_; }
  int max_iterations() const { return max_iterations_; }
  double h() const { return h_; }                  // s
  double tolerance() const { return tolerance_; }  // m
  /// [3 x n] m, of this object: the iterate, the state at the start, the prediction without forces, the poses at the end.
  const Positions& x() const { return x_; }
  const Positions& x_start() const { return x_start_; }
  const Positions& x_tilde() const { return x_tilde_; }
  const Positions& target() const { return target_; }
  /// [3 x n] N, of E at the iterate that the iteration began with.
  const Positions& gradient() const { return gradient_; }
  const std::vector<std::uint8_t>& fixed() const { return fixed_; }
  double energy();
  bool at_target();

  // --- an iteration
  /// Ends the iteration that is under way and begins the next one, assembled. False after the last that is allowed.
  bool next();
  int iteration() const { return begun_ - 1; }
  /// A s = b over free degrees of freedom: lower triangle by columns.
  struct System {
    std::vector<int> starts, rows;
    std::vector<double> values, right_side;
  };
  System system();
  /// The direction of the program's linear solver. The status that ends the step where it is of no use.
  std::optional<std::string> solve();
  /// [n_free] m; prescribed vertices go to their poses.
  void set_direction(const double* free, std::size_t n);
  /// [3 x n] m, and its slope over free degrees of freedom, J. Requires a direction.
  Positions direction();
  double slope();
  /// How far x + dx is estimated to be from the solution, m. Requires a direction.
  double error();

  // --- its motion. Errors: RuntimeError in another order, std::invalid_argument for alpha outside (0, bound]
  double bound();
  /// Change of E and the size of its rounding, J; nothing where the state is not feasible.
  std::optional<std::pair<double, double>> trial(double alpha);
  bool feasible(double alpha);
  void accept();
  bool converged();

  // --- its end
  /// Errors: std::runtime_error where Python went on after an error inside the step.
  void require_sound(const std::string& solver) const;
  /// Fills the report. Errors: std::runtime_error without an iteration.
  void finish(StepStatus status, const std::string& detail);
  void close() { system_ = nullptr; }

 private:
  template <class F>
  auto call(const F& f);
  void require_open() const;
  void require_iteration() const;
  void require_direction() const;
  void require_motion() const;
  void prepare(double alpha);
  void set_up();
  void take_direction();
  void finish_iteration();

  NewtonSystem* system_;
  StepReport* report_;
  StepObserver* observer_;
  const SaddleRule saddle_;
  const int index_, max_iterations_;
  const double h_, tolerance_;
  Positions x_, x_start_, x_tilde_, target_, gradient_;
  const std::vector<std::uint8_t> fixed_;
  std::string fault_;  // message of an error inside the step

  ErrorEstimate error_;
  EndCheck end_;
  std::optional<IterationReport> iteration_;  // under way
  IterationReport last_;                      // that is over
  int begun_ = 0;
  bool set_up_ = false, directed_ = false, prepared_ = false, moved_ = false, small_ = false;
  double level_ = 0;             // SolveReport::t of the matrix that is set up
  std::optional<double> bound_;  // of the motion
  double tried_ = 0;             // the last alpha, where it was feasible
  std::optional<EnergyChange> change_;
};

}  // namespace bb::python
