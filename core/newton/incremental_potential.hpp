// E as a sum of terms in the memory of one executor: energies, gradient, matrix, linear solve, step bound. It takes no
// decision about a step: those are NewtonSystem's, which calls it. All columns are [3 n_vertices]; vectors of free
// degrees of freedom are 0 at the others.
#pragma once

#include <string>
#include <vector>

#include "core/base/record/phase_times.hpp"
#include "core/exec/buffer.hpp"
#include "core/linear/definiteness.hpp"
#include "core/linear/forcing.hpp"
#include "core/newton/energy_change.hpp"
#include "core/newton/hessian_regularisation.hpp"
#include "core/newton/report.hpp"
#include "core/terms/term.hpp"

namespace bb {

class Archive;
class Diagnosis;
struct Cusps;
struct KnownStep;

using Column = exec::Buffer<double>;

class IncrementalPotential {
 public:
  /// clock: charged with the phases of what happens here; it must outlive the potential.
  explicit IncrementalPotential(PhaseClock& clock) : clock_(clock) {}
  IncrementalPotential(const IncrementalPotential&) = delete;
  IncrementalPotential& operator=(const IncrementalPotential&) = delete;
  virtual ~IncrementalPotential() = default;
  virtual exec::Executor& executor() = 0;

  // --- a step
  void begin_step(const StepColumns& step);
  /// The same step and iterate with another prediction and length.
  void change_step(const StepColumns& step);
  /// As Term::take_secant, of all terms; whether one of them has a secant.
  bool take_secant(double share);
  /// The terms give their secants up in the middle of the linearised iterate x: matrices that are filled from here on have none.
  /// g: N, the gradient there. A matrix engine that keeps Hessians of an iterate makes these terms' anew.
  virtual void leave_secants(const Column& /*x*/, const Column& /*g*/) { take_secant(0); }
  /// The step has converged at x: whether terms take their lagged contact state from there, so that it has to go on. One term at a time: what
  /// friction takes from contact, and how often, does not depend on how often contact was renewed.
  bool renew_lagged_state(const Column& x);
  void end_step(const Column& x);
  /// What the terms remember from step to step.
  void keep(Archive& archive);
  /// What earlier solves decide of later ones.
  virtual void keep_solver(Archive&) {}
  /// Makes the linear solver anew and forgets the pattern of the contacts: between steps.
  virtual void drop_caches() = 0;

  // --- an iterate x
  /// Every term at x; g (N) becomes the gradient of E.
  void linearise(const Column& x, Column& g);
  virtual bool pattern_changed() const = 0;
  /// The matrix of all terms at x, at a level. force: [n_vertices] N, what a level that selects vertices compares.
  virtual void fill_matrix(const Column& x, const HessianRegularisation& level, const Column& force) = 0;
  /// The matrix with the Hessian that every term begins with: the exact one where its choice has it.
  virtual void fill_exact(const Column& x, const Column& force) = 0;
  /// Adds eps I to the matrix, eps = max(relative trace/n, absolute), N/m; returns eps.
  virtual double add_tikhonov(double relative, double absolute) = 0;
  /// out = A v over free rows at least, A the matrix that was filled last.
  virtual void multiply(const Column& v, Column& out) = 0;
  /// force (N) += how the gradient changes along the motion of prescribed vertices, as far as it is in no block of A.
  void add_given_motion(const Column& x, const Column& motion, Column& force);
  /// step = A^-1 b over free degrees of freedom, A of the last fill_matrix(); of: what b is. Adds its work to the report.
  virtual void solve(const Column& b, RightSide of, Column& step, SolveReport& report) = 0;
  /// Whether the exact matrix at x is positive definite; if not, `direction` becomes one of negative curvature. near: the
  /// level of a matrix that was solved. b, step: for its own use.
  virtual Definiteness examine(const Column& x, const HessianRegularisation& near, const Column& force,
                               Column& b, Column& step, Column& direction) = 0;
  /// Entries of the lower triangle that was solved last.
  virtual std::size_t nnz() const = 0;

  // --- the motion x0 -> x1, x1 = x0 + dx up to rounding
  /// Before the calls below. to_bound: bound() will be requested, and no trial goes beyond it.
  void prepare(const Column& x0, const Column& x1, const Column& dx, bool to_bound);
  /// Largest feasible fraction, in [0, 1]; each term reports its own in the report.
  double bound(const Column& x0, const Column& x1, const Column& dx, IterationReport& report) {
    return smallest_bound({x0, x1, dx}, report, false);
  }
  /// Whether some term bounds each vertex by itself; then dx of each becomes the part of it that the last bound() lets it go,
  /// and prescribed vertices go the smallest of theirs, which is returned.
  bool bounds_each_vertex() const;
  virtual double truncate(Column& /*dx*/) { return 1; }
  /// bound() of the terms that do not bound each vertex by itself, of a motion that was truncated.
  double bound_truncated(const Column& x0, const Column& x1, const Column& dx, IterationReport& report) {
    return smallest_bound({x0, x1, dx}, report, true);
  }
  /// As Term::bound_audited, of all terms.
  void bound_audited(bool bound);
  /// As Term::prove_step: the smallest of all terms, with the queries and probes of all.
  StepBound prove_step(const Column& x_n, const Column& x);
  std::string describe_bound() const { return holder_ ? holder_->describe_bound() : std::string(); }
  /// force (N) becomes the curvature correction for gaps that are curved along dx, of a motion that bound() ends at `bound`. Whether
  /// curvature is what holds it. The matrix is that of the last fill_matrix() again, whatever was filled since.
  bool curvature_correction(const Column& x, const Column& dx, double bound, Column& force);
  /// Whether the trial, which is rounded to the precision of the run first, is finite and feasible, and what the terms
  /// keep of it then. No energy of the trial is evaluated.
  bool is_feasible(const Column& x, Column& trial);
  /// E(trial) - E(x) of the trial that was admitted last.
  EnergyChange change(const Column& x, const Column& trial);
  /// The trial that was admitted last is the iterate. What is reported of it holds whether its energies were requested or not.
  void accept();

  // --- what is reported of the iterate x
  /// As StepView::announce.
  void announce(const Column& x);
  double energy(TermSet set, const Column& x);
  void report(const Column& x, IterateNumbers& out);
  void report_end(const Column& x, StepNumbers& out);
  /// Elements at a cusp.
  virtual Cusps cusps(const Column& x, double t_end) = 0;
  /// The first element with a number that is not finite; empty without one.
  virtual std::string describe_non_finite() = 0;
  /// What is frozen for the step, for the copy on the host.
  virtual KnownStep known_step() const = 0;

 protected:
  PhaseClock& clock() const { return clock_; }
  /// Once, in the order of registry.inc. They stay where they are.
  template <class Terms>
  void set_terms(const Terms& terms) {
    for (const auto& term : terms) terms_.push_back(term.get());
  }

  // --- what a matrix engine has of its own
  virtual void solver_begins_step() {}
  virtual void linearise_terms(const Column& x, Column& g) = 0;
  /// Rounds the trial; whether all its numbers are finite, as far as no term sees that.
  virtual bool is_finite(Column& trial, bool seen_by_terms) = 0;
  virtual bool bounds_each_vertex_of(const Term&) const { return false; }
  /// What add_curvature_correction() needed may be gone: the matrix is filled again.
  virtual void room_was_made(const Column& /*x*/) {}
  /// Sums of what the terms evaluated at x and at the trial.
  virtual EnergyChange sum_change(const Column& x, const Column& trial) = 0;
  /// Whether what is reported of a state is launched before it is read; then announce_energy() launches the sum of E at x.
  virtual bool launches() const { return false; }
  virtual void announce_energy(const Column& /*x*/) {}
  /// announced: announce_energy() was of this x.
  virtual double sum_energy(TermSet set, const Column& x, bool announced) = 0;

 private:
  void know_energies(const Column& x);
  double smallest_bound(const Motion& motion, IterationReport& report, bool truncated);

  PhaseClock& clock_;
  std::vector<Term*> terms_;
  const Term* holder_ = nullptr;                           // of the last bound
  bool energies_known_ = false, trial_evaluated_ = false;  // of the iterate; of the trial
  bool announced_ = false;                                 // E of the iterate
};

}  // namespace bb
