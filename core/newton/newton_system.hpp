// The Newton step: which sums are made when, how a matrix becomes positive definite, where directions lead. The vectors
// are columns of an executor, the terms an IncrementalPotential on it; host and card run this code.
#pragma once

#include <memory>
#include <optional>

#include "core/newton/constraint_system.hpp"
#include "core/newton/diagnosis.hpp"
#include "core/newton/newton_state.hpp"
#include "core/newton/newton_view.hpp"
#include "core/newton/step_system.hpp"

namespace bb {

class NewtonSystem : public StepSystem {
 public:
  /// scene and method must outlive the system. plan: of both. Its terms are those of the method's make_potential, or on
  /// the host. Errors: ConfigError for what the potential refuses; exec::OutOfMemory.
  NewtonSystem(const Scene& scene, Method& method, const Plan& plan);
  /// With the plan of scene and method alone.
  NewtonSystem(const Scene& scene, Method& method);
  ~NewtonSystem() override;

  void begin_step(const Positions& x_n, const Prediction& prediction, double dt, double load_factor) override;
  void restart_step(const Prediction& prediction, double dt) override;
  bool take_secant(double share) override;
  bool renew_lagged_state() override { return state_.potential->renew_lagged_state(state_.x); }
  void end_step() override;
  void set_target(const Positions& target) override;
  void keep(Archive& archive) override { state_.potential->keep(archive); }
  void keep_solver(Archive& archive) override { state_.potential->keep_solver(archive); }
  void drop_caches() override { state_.potential->drop_caches(); }

  void assemble() override;
  double add_tikhonov(double relative, double absolute) override;
  SolveReport find_direction() override;
  DirectionSize direction_size() override;
  void scale_direction(double factor) override;
  double direction_curvature() override;
  EndCheck check_end() override;
  void aim_at_escape(double length) override;

  void prepare_motion(MotionEnd end, bool to_bound) override;
  double bound_motion(IterationReport& report) override;
  std::optional<TruncatedMotion> truncate_motion(IterationReport& report) override;
  bool correct_curvature(double bound, SolveReport& report) override;
  void restore_direction() override {
    state_.dx.swap(state_.aside);
    state_.direction_seen = false;
  }
  bool try_feasible(double alpha) override;
  std::optional<EnergyChange> try_motion(double alpha) override;
  void accept() override;

  const StepView& view() const override { return view_; }
  NewtonSystem& on_host() override;
  bool is_on_host() const override;

  // --- a step that is proven when it is over
  void bound_audited(bool bound) { state_.potential->bound_audited(bound); }
  /// Of the motion from the start of the step to the iterate.
  StepBound prove_step() { return state_.potential->prove_step(state_.x_n, state_.x); }

  // --- states from elsewhere
  /// dx [3 x n] m, in the place of a Newton direction.
  void set_direction(const Positions& dx);
  /// Sets up the system A s = b of the assembled iterate without solving it: diagnosis().solved() and rhs() are its. dx becomes
  /// the motion of prescribed vertices, 0 elsewhere. Returns how far A is from exact (SolveReport::t).
  double set_up_system();
  /// Moves the iterate to x [3 x n] m along a straight motion. Errors: std::logic_error where x is not feasible.
  void go_to(const Positions& x);
  /// The iterate of another system on the host, made from the same scene and method, in a step that began as `frame` says,
  /// assembled; prescribed vertices stay. Policies are evaluated and not updated: none starts here. Cost: two assemblies.
  void adopt(const StepFrame& frame, NewtonSystem& other);
  /// Terms and matrices of the iterate. Errors: std::logic_error elsewhere than on the host.
  Diagnosis& diagnosis();
  /// The step for a solver of constraints. Errors: std::logic_error elsewhere than on the host.
  ConstraintSystem& constraints();
  IncrementalPotential& potential() { return *state_.potential; }

 private:
  NewtonSystem(const Scene& scene, Method& method, const Plan& plan, const MakePotential& make);
  StepColumns step_columns() const;
  void mirror(const Positions& target, const NewtonState& of, const Positions& x);
  double largest_force();
  void fill_matrix();
  bool set_right_hand_side();
  bool find_one_direction(SolveReport& report);
  EndCheck check_hessian();
  void look_for_cusps(EndCheck& out);
  void take_solution();
  void look_at_direction();
  void move(double alpha, Column& to);
  HostEngine& host_engine();

  Method& method_;
  NewtonState state_;
  NewtonView view_;
  const ExactHessians exact_hessians_;
  bool factored_ = false;        // the last solve made a factor of the matrix that it solved
  bool served_at_once_ = false;  // the first matrix of the last solve did: the next may be nearer to exact
  double dt_ = 0, c_ = 1, load_factor_ = 1, t_end_ = 0;
  bool at_start_ = false;
  Positions target_;
  MotionEnd end_ = MotionEnd::free;  // of the motion in progress
  std::unique_ptr<Diagnosis> diagnosis_;
  std::unique_ptr<ConstraintSystem> constraints_;
  std::unique_ptr<NewtonSystem> host_;  // the copy of on_host()
};

}  // namespace bb
