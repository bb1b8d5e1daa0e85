// What a step solver calls: E at one iterate, its Newton direction, trial states along it. The iterate and all vectors
// belong to the system, so that they may live on a device; numbers come out, and what is read besides is in StepView.
// NewtonSystem is the one that runs.
#pragma once

#include <optional>
#include <string>

#include "core/base/record/phase_times.hpp"
#include "core/model/integrators/integrator.hpp"
#include "core/newton/energy_change.hpp"
#include "core/newton/report.hpp"
#include "core/newton/step_view.hpp"

namespace bb {

class Archive;
class NewtonSystem;

/// Sizes of a Newton direction over free degrees of freedom; NaN where an entry is NaN.
struct DirectionSize {
  double inf_m = 0;       // largest |dx_i|
  double beyond_m = 0;    // of those that stand out of the rounding of their vertex (rounding_room.hpp)
  double rounding_m = 0;  // of the others
  double slope_J = 0;     // g . dx
  double vertex_m = 0;    // largest |dx| of a vertex, prescribed ones included
};

/// Whether the exact matrix of an iterate is positive definite, and no element at a cusp.
struct EndCheck {
  EndProof proof = EndProof::not_checked;
  double curvature_N_per_m = 0;  // saddle: v^T H v / v^T v of the direction v that was found
  int factorizations = 0, iterations = 0;
  int cusps = 0;           // elements at one
  std::string first_cusp;  // its term, number and vertices
};

/// A motion whose vertices go each the part that contact lets them go.
struct TruncatedMotion {
  double bound = 1;    // in [0, 1], of what has one bound for all vertices
  double of_pins = 1;  // part that prescribed vertices go
};

/// Where prescribed vertices are at the whole of a motion: at x + dx, or exactly at their target.
enum class MotionEnd { free, on_target };

class StepSystem {
 public:
  StepSystem() = default;
  StepSystem(const StepSystem&) = delete;
  StepSystem& operator=(const StepSystem&) = delete;
  virtual ~StepSystem() = default;

  // --- a step
  /// Starts a step at x_n [3 x n] m. load_factor scales the external force (1, or the load step of quasi_static).
  virtual void begin_step(const Positions& x_n, const Prediction& prediction, double dt,
                          double load_factor) = 0;
  /// The same step and iterate with another prediction and length (accumulated_toi).
  virtual void restart_step(const Prediction& prediction, double dt) = 0;
  /// From the next assemble() of the step on terms have that share, in [0, 1], of their secant in the matrix (Term::take_secant);
  /// whether one has one. check_end() is of the exact matrix, and those of the iterate are from then on.
  virtual bool take_secant(double /*share*/) { return false; }
  /// The step has converged: whether terms take their lagged contact state from this iterate (friction), so that it has to go on.
  virtual bool renew_lagged_state() { return false; }
  virtual void end_step() = 0;
  /// Where directions lead the prescribed vertices: [3 x n] m, read at these only.
  virtual void set_target(const Positions& target) = 0;
  /// What is remembered from step to step.
  virtual void keep(Archive& archive) = 0;
  /// What earlier solves decide of later ones (LinearSolver::keep), where drop_caches() is not called between steps.
  virtual void keep_solver(Archive& archive) = 0;
  /// Forgets what earlier steps left to the next, but for what keep() has: between steps.
  virtual void drop_caches() = 0;

  // --- an iterate
  /// Every term at the iterate, then gradient and matrix.
  virtual void assemble() = 0;
  /// Adds eps I to the assembled matrix, eps = max(relative trace / n, absolute), N/m; returns eps. It stays until the
  /// next assemble(), in the matrix that is solved only.
  virtual double add_tikhonov(double relative, double absolute) = 0;
  /// Newton direction towards the target: A dx = -(g + lifted prescribed motion). While the matrix is not positive
  /// definite, or dx does not descend, the Hessian is brought nearer to the clamped one as its terms' choices allow
  /// (StepHessian). Cost: an assembly and a solve an attempt.
  virtual SolveReport find_direction() = 0;
  virtual DirectionSize direction_size() = 0;
  virtual void scale_direction(double factor) = 0;
  /// dx^T H dx, J, of the exact Hessian where a term began with it, of its own choice elsewhere. Cost: an assembly.
  virtual double direction_curvature() = 0;
  /// Whether that Hessian is positive definite at the iterate, after find_direction(); the direction stays. A
  /// factor of the very matrix that was solved shows it for free.
  virtual EndCheck check_end() = 0;
  /// After a check that found a saddle or a cusp: dx becomes the direction of negative curvature, or a seeded one of the elements at
  /// the cusp, with |dx|_inf = length (m), so that E does not grow along it to first order.
  virtual void aim_at_escape(double length) = 0;

  // --- the motion from the iterate along dx
  /// Before the calls below. to_bound: the bound will be requested, and no trial goes beyond it.
  virtual void prepare_motion(MotionEnd end, bool to_bound) = 0;
  /// Largest feasible fraction of the motion, in [0, 1]; each term reports its own in the report.
  virtual double bound_motion(IterationReport& report) = 0;
  /// After bound_motion(), where contact bounds each vertex by itself: dx of each becomes the part that it may go, and the
  /// motion along that is the motion in progress. Nothing, and dx as it was, where one bound serves all vertices.
  virtual std::optional<TruncatedMotion> truncate_motion(IterationReport&) { return std::nullopt; }
  /// Of a direction that contact ends at `bound`, prescribed vertices at their target: where curved gaps hold it, dx gets
  /// a second-order correction from the matrix that was solved, and becomes another motion. False: it stays.
  virtual bool correct_curvature(double bound, SolveReport& report) = 0;
  /// dx as it was before correct_curvature(), truncate_motion() or aim_at_escape().
  virtual void restore_direction() = 0;
  /// Whether x + alpha dx, rounded to the precision of the run, is finite and feasible. No energy there is evaluated.
  virtual bool try_feasible(double alpha) = 0;
  /// Evaluates E there too. Returns the change against the iterate; an infeasible state has none.
  virtual std::optional<EnergyChange> try_motion(double alpha) = 0;
  /// Makes the last tried state, which was feasible, the iterate.
  virtual void accept() = 0;

  // --- what is read of it
  virtual const StepView& view() const = 0;
  /// The state in the host's memory, assembled, for what reads terms and matrices: this system, or a copy at the cost of
  /// two assemblies. Valid until the next call of this one.
  virtual NewtonSystem& on_host() = 0;
  /// Whether that is this system.
  virtual bool is_on_host() const = 0;

  /// Charges what happens in this system and round it to phases.
  PhaseClock& clock() const { return clock_; }

 private:
  mutable PhaseClock clock_;
};

}  // namespace bb
