// A run: steps one after the other, each by the step solver, with the integrator's prediction
// and velocity update.
#pragma once

#include <memory>
#include <vector>

#include "core/model/scene/held_scene.hpp"
#include "core/newton/end_residual.hpp"
#include "core/newton/newton_system.hpp"
#include "core/newton/step_parts.hpp"
#include "core/newton/step_size.hpp"
#include "core/newton/step_solver.hpp"

namespace bb {

class Simulation {
 public:
  /// scene and method must outlive the simulation. plan: of both. dt in s; n_steps gives the load
  /// steps of quasi_static.
  Simulation(const Scene& scene, Method& method, const Plan& plan, double dt, int n_steps);
  /// With the plan of scene and method alone.
  Simulation(const Scene& scene, Method& method, double dt, int n_steps);

  /// Advances one time step. One that fails is tried again from its start with half the length, as often as the
  /// options of the step solver report; the rest of the nominal step is done in steps of that length by the next
  /// calls (docs/reference/outcomes.md). One that ends in a state to which pairs that collide
  /// as `audited` may have passed through each other is done again from its start with every motion bounded.
  /// A status other than converged, after the last attempt,
  /// keeps the feasible state that was reached. Counters and times of the report are those of all attempts,
  /// everything else is of the last one.
  StepReport step(StepObserver& observer);
  /// All that the next step depends on: a simulation that read it goes on, bit for bit, as the one that wrote it.
  void keep(Archive& archive);
  /// The first part of it: positions, velocities and time, without what terms, policies and solvers remember. A simulation with
  /// another step solver begins with that part of an archive.
  void keep_motion(Archive& archive);
  /// Forgets what earlier steps left on a device, so that the next step is that of a run that goes on elsewhere.
  void drop_caches();

  const History& history() const { return history_; }
  NewtonSystem& step_system() { return *system_; }
  /// The state as the CPU sees it.
  NewtonSystem& system() { return system_->on_host(); }
  double time() const { return history_.t; }
  /// Nominal steps that are over.
  int nominal_steps() const { return nominal_; }

 private:
  void make_system();
  bool hold_pins(std::vector<int> holding);
  void begin_anew();
  void start_acceleration();
  bool other_pulls() const;
  StepReport attempt(StepObserver& observer);
  StepReport attempt_until_converged(StepObserver& observer);
  bool is_proven(StepReport& report);
  void go_back(const Archive& start, bool halve, bool bound_audited);
  void measure_residual(StepReport& report);
  void choose_length(const StepReport& report, int halvings);
  void remember(const PositionsView& x, double dt_used);
  void follow_pins(double t_end, double dt);
  void advance_time(double dt_used);

  const Scene& scene_;
  HeldScene held_;  // of it, with the pins of the step
  Method& method_;
  const Plan plan_;
  double dt_ = 0;
  int n_steps_ = 0, step_ = 0, nominal_ = 0;  // step_: every part counts
  double nominal_start_ = 0;                  // s
  double load_factor_ = 1;                    // of the last attempt
  long long broken_ = 0;                      // stitches, once the last step is over
  bool broke_ = false;                        // whether any of them broke in it
  StepSize size_;
  StepParts parts_;
  std::unique_ptr<NewtonSystem> system_;
  const StepSolverEntry entry_;  // a copy: the registry may get others while it runs
  const bool proves_steps_;      // of pairs that collide as `audited`
  std::unique_ptr<StepSolver> solver_;
  std::unique_ptr<EndResidual> end_residual_;  // of a step solver that does not have to converge
  History history_;
  Prediction prediction_;
  Positions v_next_, a_next_;
};

}  // namespace bb
