// E as a sum of terms in the memory of one executor: energies, gradient, matrix, linear solve, step bound. It takes no
// decision about a step: those are NewtonSystem's, which calls it. All columns are [3 n_vertices]; vectors of free
// degrees of freedom are 0 at the others.
#pragma once

#include <string>

#include "core/exec/buffer.hpp"
#include "core/linear/definiteness.hpp"
#include "core/linear/forcing.hpp"
#include "core/newton/energy_change.hpp"
#include "core/newton/hessian_level.hpp"
#include "core/newton/report.hpp"
#include "core/record/phase_times.hpp"
#include "core/terms/term_set.hpp"

namespace bb {

class Archive;
class Diagnosis;
struct Cusps;
struct KnownStep;

using Column = exec::Buffer<double>;

/// One time step: where it starts and leads without force, s, inertia weight c, factor of the external force, and the time
/// at its end, s. at_start: as in Prediction.
struct StepColumns {
  const Column &x_n, &x_tilde;
  double dt = 0, c = 1, load_factor = 1, t_end = 0;
  bool at_start = false;
};

class IncrementalPotential {
 public:
  /// clock: charged with the phases of what happens here; it must outlive the potential.
  explicit IncrementalPotential(PhaseClock& clock) : clock_(clock) {}
  IncrementalPotential(const IncrementalPotential&) = delete;
  IncrementalPotential& operator=(const IncrementalPotential&) = delete;
  virtual ~IncrementalPotential() = default;
  virtual exec::Executor& executor() = 0;

  // --- a step
  virtual void begin_step(const StepColumns& step) = 0;
  /// The same step and iterate with another prediction and length.
  virtual void change_step(const StepColumns& step) = 0;
  /// The step has converged at x: whether terms take what they lag from there, so that it has to go on.
  virtual bool renew_lag(const Column& /*x*/) { return false; }
  virtual void end_step(const Column& x) = 0;
  /// What the terms remember from step to step.
  virtual void keep(Archive& archive) = 0;
  /// What earlier solves decide of later ones.
  virtual void keep_solver(Archive&) {}
  /// Makes the linear solver anew and forgets the pattern of the contacts: between steps.
  virtual void drop_caches() = 0;

  // --- an iterate x
  /// Every term at x; g (N) becomes the gradient of E.
  virtual void linearise(const Column& x, Column& g) = 0;
  virtual bool pattern_changed() const = 0;
  /// The matrix of all terms at x, at a level. force: [n_vertices] N, what a level that asks vertices compares.
  virtual void fill_matrix(const Column& x, const HessianLevel& level, const Column& force) = 0;
  /// The matrix with the Hessian that every term begins with: the exact one where its choice has it.
  virtual void fill_exact(const Column& x, const Column& force) = 0;
  /// Adds eps I to the matrix, eps = max(relative trace/n, absolute), N/m; returns eps.
  virtual double add_tikhonov(double relative, double absolute) = 0;
  /// out = A v over free rows at least, A the matrix that was filled last.
  virtual void multiply(const Column& v, Column& out) = 0;
  /// force (N) += how the gradient changes along the motion of prescribed vertices, as far as it is in no block of A.
  virtual void add_given_motion(const Column& x, const Column& motion, Column& force) = 0;
  /// step = A^-1 b over free degrees of freedom, A of the last fill_matrix(); of: what b is. Adds its work to the report.
  virtual void solve(const Column& b, RightSide of, Column& step, SolveReport& report) = 0;
  /// Whether the exact matrix at x is positive definite; if not, `direction` becomes one of negative curvature. near: the
  /// level of a matrix that was solved. b, step: for its own use.
  virtual Definiteness examine(const Column& x, const HessianLevel& near, const Column& force, Column& b,
                               Column& step, Column& direction) = 0;
  /// Entries of the lower triangle that was solved last.
  virtual std::size_t nnz() const = 0;

  // --- the motion x0 -> x1, x1 = x0 + dx up to rounding
  /// Before the calls below. to_bound: bound() will be asked for, and no trial goes beyond it.
  virtual void prepare(const Column& x0, const Column& x1, const Column& dx, bool to_bound) = 0;
  /// Largest feasible fraction, in [0, 1]; each term says its own in the report.
  virtual double bound(const Column& x0, const Column& x1, const Column& dx, IterationReport& report) = 0;
  /// Whether some term bounds each vertex by itself; then dx of each becomes the part of it that the last bound() lets it go,
  /// and prescribed vertices go the smallest of theirs, which is returned.
  virtual bool bounds_each_vertex() const { return false; }
  virtual double truncate(Column& /*dx*/) { return 1; }
  /// bound() of the terms that said nothing about each vertex, of a motion that was truncated.
  virtual double bound_truncated(const Column& /*x0*/, const Column& /*x1*/, const Column& /*dx*/,
                                 IterationReport&) {
    return 1;
  }
  virtual std::string describe_bound() const = 0;
  /// force (N) becomes what makes room for gaps that are curved along dx, of a motion that bound() ends at `bound`. Whether
  /// curvature is what holds it. The matrix is that of the last fill_matrix() again, whatever was filled since.
  virtual bool make_room(const Column& x, const Column& dx, double bound, Column& force) = 0;
  /// Whether the trial, which is rounded to the precision of the run first, is finite and feasible, and what the terms
  /// keep of it then. No energy of the trial is evaluated.
  virtual bool admits(const Column& x, Column& trial) = 0;
  /// E(trial) - E(x) of the trial that was admitted last.
  virtual EnergyChange change(const Column& x, const Column& trial) = 0;
  /// The trial that was admitted last is the iterate. What is said of it holds whether its energies were asked for or not.
  virtual void accept() = 0;

  // --- what is said of the iterate x
  /// As StepView::announce.
  virtual void announce(const Column& /*x*/) {}
  virtual double energy(TermSet set, const Column& x) = 0;
  virtual void report(const Column& x, IterateNumbers& out) = 0;
  virtual void report_end(const Column& x, StepNumbers& out) = 0;
  /// Elements at a cusp.
  virtual Cusps cusps(const Column& x) = 0;
  /// The first element with a number that is not finite; empty without one.
  virtual std::string describe_non_finite() = 0;
  /// What is frozen for the step, for the copy on the host.
  virtual KnownStep known_step() const = 0;

 protected:
  PhaseClock& clock() const { return clock_; }

 private:
  PhaseClock& clock_;
};

}  // namespace bb
