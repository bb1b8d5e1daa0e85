// A step solver drives one time step to its end: what it is, what it declares. line_search.cpp is the one to read first; the others
// are in core/step_solvers.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/parameters/registry.hpp"
#include "core/base/record/solver_counts.hpp"
#include "core/math/error.hpp"
#include "core/newton/method.hpp"
#include "core/newton/report.hpp"
#include "core/newton/step_system.hpp"
#include "core/terms/step_needs.hpp"

namespace bb {

/// What a step has to do.
struct StepTask {
  int step = 0;
  double dt = 0;                     // s
  double load_factor = 1;            // of the external force
  const History* history = nullptr;  // state at the start
  const Integrator* integrator = nullptr;
  /// Pose of the prescribed vertices at the end of a step of length dt, written into their columns.
  std::function<void(double dt, Positions& target)> pose;
};

class StepSolver {
 public:
  virtual ~StepSolver() = default;
  virtual std::string_view name() const = 0;
  /// Errors: ConfigError for what a system has that it cannot step.
  virtual void require(StepSystem&) const {}
  /// Leaves the reached state in system.x(), and in `used` the prediction that it belongs to. The
  /// report's counters, status and dt_s are filled; the rest is the caller's.
  virtual StepReport advance(StepSystem& system, const StepTask& task, Prediction& used,
                             StepObserver& observer) = 0;
};

/// What it requires of the settings of a run.
struct StepSettings {
  bool implicit_euler = false;  // no other integrator
  /// Integrators alone whose velocity is that of the step (Integrator::velocity_of_step): a contact stops what comes within one step,
  /// which formulas of second order take for an acceleration that goes on.
  bool velocity_of_step = false;
  bool clamped = false;  // every Hessian clamped
  bool unmoved = false;  // what is prescribed stays where it starts, and is so from the start
  bool own_stiffness =
      false;  // springs resist by another stiffness than theirs, so that none breaks by tension
  bool vertex_steps =
      false;             // it can go another part of a step at each vertex, so bounds of vertices are allowed
  std::string protocol;  // of a scene that no other solver follows, and that it follows alone; empty: none
  /// Whether a setting takes the step bound away that it needs otherwise; null: none does.
  bool (*unbounded)(const ParameterMap& complete) = nullptr;
  /// The first of its own settings that contradicts another; where: its name.
  std::optional<Violation> (*contradiction)(const ParameterMap& complete, int max_iterations) = nullptr;
};

struct StepSolverEntry {
  std::string name, doc;
  std::string guarantee;              // what every state that a step ends in has, in plain words
  std::vector<Parameter> parameters;  // its own, with defaults
  bool stated_always = true;          // false: a resolved config has its own settings only where it is chosen
  std::vector<SolverCounter> counters;  // that its steps fill in StepReport::solver, all of them
  StepNeeds needs;
  StepSettings settings;
  /// m, how far a surface may be beyond an obstacle at the end of a step that converges; null: not at all.
  double (*promised_overlap)(const ParameterMap& complete) = nullptr;
  bool asked_to_converge = true;  // false: a step is over by another rule than the size of its directions
  /// Whether steps end in a state whose contact rows carry forces: those of the last system that was solved.
  bool has_forces = true;
  void (*set_terms)(const StepSolverOptions& complete,
                    TermOptions&) = nullptr;  // what it requires of terms by numbers
  std::function<std::unique_ptr<StepSolver>(const StepSolverOptions& complete)> make;
};

}  // namespace bb
