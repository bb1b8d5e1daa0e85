// What a step solver calls: E at one iterate, its Newton direction, trial states along it. The iterate and all vectors
// belong to the system, so that they may live on a device; numbers come out, vectors only where somebody asks for them.
// NewtonSystem is the one on the CPU.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/integrators/integrator.hpp"
#include "core/math/precision.hpp"
#include "core/newton/energy_sum.hpp"
#include "core/newton/report.hpp"
#include "core/record/phase_times.hpp"
#include "core/scene/scene.hpp"
#include "core/terms/term_set.hpp"

namespace bb {

class Archive;
class NewtonSystem;

/// Sizes of a Newton direction over free degrees of freedom; NaN where an entry is no number.
struct DirectionSize {
  double inf_m = 0;       // largest |dx_i|
  double beyond_m = 0;    // of those that stand out of the rounding of their vertex (rounding_room.hpp)
  double rounding_m = 0;  // of the others
  double slope_J = 0;     // g . dx
  double vertex_m = 0;    // largest |dx| of a vertex, prescribed ones included
};

/// Whether the exact matrix of an iterate is positive definite.
struct EndCheck {
  EndProof proof = EndProof::not_checked;
  double curvature_N_per_m = 0;  // saddle: v^T H v / v^T v of the direction v that was found
  int factorizations = 0, iterations = 0;
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
  /// Starts a step at x_n. load_factor scales the external force (1, or the load step of quasi_static).
  virtual void begin_step(const Positions& x_n, const Prediction& prediction, double dt,
                          double load_factor) = 0;
  /// The same step and iterate with another prediction and length (accumulated_toi).
  virtual void restart_step(const Prediction& prediction, double dt) = 0;
  virtual void end_step() = 0;
  /// Where directions lead the prescribed vertices: [3 x n], read at these only.
  virtual void set_target(const Positions& target) = 0;
  /// Prescribed vertices stay where they are.
  virtual void hold() = 0;
  virtual bool at_target() const = 0;
  /// What is remembered from step to step.
  virtual void keep(Archive& archive) = 0;
  /// Forgets what earlier steps left to the next, but for what keep() has.
  virtual void drop_caches() = 0;
  /// What earlier solves decide of later ones (LinearSolver::keep), where drop_caches() is not called between steps.
  virtual void keep_solver(Archive&) {}

  // --- an iterate
  /// Every term at the iterate, then gradient and matrix.
  virtual void assemble() = 0;
  /// Adds eps I to the assembled matrix, eps = max(relative trace / n, absolute); returns eps. It stays until the next
  /// assemble(), in the matrix that is solved only.
  virtual double add_tikhonov(double relative, double absolute) = 0;
  /// Newton direction towards the target: A dx = -(g + lifted prescribed motion). While the matrix is not positive
  /// definite, or dx does not descend, the Hessian is brought nearer to the clamped one as its terms' choices allow.
  virtual SolveReport find_direction() = 0;
  virtual DirectionSize direction_size() = 0;
  virtual void scale_direction(double factor) = 0;
  /// dx^T H dx, J, of the exact Hessian where a term began with it, of its own choice elsewhere.
  virtual double direction_curvature() = 0;
  /// Whether that Hessian is positive definite at the iterate, after find_direction(); the direction stays. A
  /// factor of the very matrix that was solved shows it for free.
  virtual EndCheck check_end() = 0;
  /// After a check that found a saddle: dx becomes the direction of negative curvature with |dx|_inf = length (m), so
  /// that E does not grow along it to first order.
  virtual void aim_at_escape(double length) = 0;
  /// Whether no element of the solved matrix was clamped that its choice begins with exact.
  virtual bool solved_is_exact() const = 0;

  // --- the motion from the iterate along dx
  /// Before the calls below. to_bound: the bound will be asked for, and no trial goes beyond it.
  virtual void prepare_motion(MotionEnd end, bool to_bound) = 0;
  /// Largest feasible fraction of the motion, in [0, 1].
  virtual double bound_motion(IterationReport& report) = 0;
  /// Of a direction that contact ends at `bound`, prescribed vertices at their target: where curved gaps hold it, dx gets
  /// a second-order correction from the matrix that was solved, and becomes another motion. False: it stays.
  virtual bool make_detour(double /*bound*/, SolveReport& /*report*/) { return false; }
  /// dx as it was before make_detour() or aim_at_escape().
  virtual void restore_direction() = 0;
  /// What held the last bound; empty where nothing did.
  virtual std::string describe_bound() const = 0;
  /// Evaluates E at x + alpha dx. Returns the change against the iterate; an infeasible state has none.
  virtual std::optional<EnergyChange> try_motion(double alpha) = 0;
  /// Makes the last tried state the iterate.
  virtual void accept() = 0;

  // --- what is read of it
  virtual const Scene& scene() const = 0;
  virtual Precision precision() const = 0;
  /// The iterate, and the one before the last accept(), m. Elsewhere than on the CPU a call copies it.
  virtual const Positions& x() const = 0;
  virtual const Positions& x_before() const = 0;
  /// Of E at the iterate, N.
  virtual const Positions& gradient() const = 0;
  virtual double grad_inf() const = 0;
  /// E at the iterate, J; for the record only.
  virtual double energy() const = 0;
  /// The parts of E that a group has, J.
  virtual double energy(TermGroup group) const = 0;
  virtual bool pattern_changed() const = 0;
  virtual int n_free() const = 0;
  /// Entries of the lower triangle that was solved last.
  virtual std::size_t nnz() const = 0;
  /// [3 n] prescribed or locked degrees of freedom.
  virtual const std::vector<std::uint8_t>& fixed() const = 0;
  /// What the terms say of the iterate, and of the end of a step.
  virtual void report(IterateNumbers& out) const = 0;
  virtual void report_end(StepNumbers& out) const = 0;
  /// Of a step without progress. with_direction: the Newton direction at the iterate is known, else it counts as 0.
  virtual void report_overload(bool with_direction, StepNumbers& out) = 0;
  /// Where numbers that are no numbers began.
  virtual std::string describe_non_finite() const = 0;
  /// The state as the CPU sees it, assembled: for observers that read terms and matrices. Costs two assemblies where
  /// it is another system. Valid until the next call of this one.
  virtual NewtonSystem& on_cpu() = 0;
  /// Whether that is this system.
  virtual bool is_on_cpu() const { return false; }

  /// Charges what happens in this system and round it to phases.
  PhaseClock& clock() const { return clock_; }

 private:
  mutable PhaseClock clock_;
};

}  // namespace bb
