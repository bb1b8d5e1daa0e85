// A run: steps one after the other, each by the step solver, with the integrator's prediction
// and velocity update.
#pragma once

#include <memory>
#include <vector>

#include "core/newton/newton_system.hpp"
#include "core/newton/step_solver.hpp"

namespace bb {

class Simulation {
 public:
  /// scene and method must outlive the simulation. plan: of both. dt in s; n_steps gives the load
  /// steps of quasi_static.
  Simulation(const Scene& scene, Method& method, const Plan& plan, double dt, int n_steps);
  /// With the plan of scene and method alone.
  Simulation(const Scene& scene, Method& method, double dt, int n_steps);

  /// Goes on from a state of another simulation of the same scene, in front of its step `step` at `time` s.
  void resume(const History& history, int step, double time);
  /// Advances one time step. A status other than converged keeps the feasible state that was reached.
  StepReport step(StepObserver& observer);

  const History& history() const { return history_; }
  const NewtonSystem& system() const { return system_; }
  NewtonSystem& system() { return system_; }
  double time() const { return time_; }

 private:
  void start_acceleration();
  void remember(const Positions& x, double dt_used);

  const Scene& scene_;
  Method& method_;
  double dt_ = 0, time_ = 0;
  int n_steps_ = 0, step_ = 0;
  NewtonSystem system_;
  std::unique_ptr<StepSolver> solver_;
  History history_;
  Prediction prediction_;
  Positions v_next_, a_next_;
};

}  // namespace bb
