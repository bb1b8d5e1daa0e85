// A term of E, the incremental potential (docs/architecture.md, Terms): what the Newton step requires of it, wherever it runs. A term is one file
// of this module and one line of registry.inc. It owns what it computes, in the memory of its executor; positions (m) are there too.
#pragma once

#include <string>
#include <string_view>

#include "core/base/record/phase_times.hpp"
#include "core/energy/families/family_step.hpp"
#include "core/math/types.hpp"
#include "core/terms/report.hpp"
#include "core/terms/term_set.hpp"

namespace bb {

class Archive;

/// One time step, the same for all terms. What it views outlives the step.
struct StepColumns {
  PositionsView x_n, x_tilde;  // start of the step and prediction
  double dt = 0;               // s
  double c = 1;                // inertia weight M/(c dt^2); 0 when quasi-static
  double load_factor = 1;      // of the external force
  double t_end = 0;            // s, when the step is over: what is given as a function of time is taken there
  bool at_start = false;       // no step: forces at t_end, where a step of length dt begins
  FamilyStep of_families() const { return {x_n.data(), x_tilde.data(), dt, c, load_factor, t_end, at_start}; }
};

/// The same with positions of its own, on the host.
struct StepFrame {
  Positions x_n, x_tilde;
  double dt = 0, c = 1, load_factor = 1, t_end = 0;
  bool at_start = false;
  operator StepColumns() const& {  // NOLINT(google-explicit-constructor)
    return {x_n, x_tilde, dt, c, load_factor, t_end, at_start};
  }
  operator StepColumns() const&& = delete;  // the positions would be gone
};

/// Straight motion of a whole step: x0 -> x1, x1 - x0 = dx up to rounding; x1 is exact
/// at prescribed vertices.
struct Motion {
  PositionsView x0, x1, dx;
  bool to_bound = false;  // no state beyond what bound() allows will be tried
};

class Term {
 public:
  Term() = default;
  Term(const Term&) = delete;
  Term& operator=(const Term&) = delete;
  virtual ~Term() = default;

  /// That of its line in registry.inc.
  virtual std::string_view name() const = 0;
  virtual TermGroup group() const = 0;
  /// What linearising is charged to.
  virtual Phase phase() const = 0;

  // --- a step
  /// A step from step.x_n begins: it is the iterate now, and what belongs to the step before is forgotten.
  virtual void begin_step(const StepColumns& step, PhaseClock&) { change_step(step); }
  /// The same step and iterate with another prediction and length.
  virtual void change_step(const StepColumns&) {}
  /// From the next linearisation of the step on its Hessian has that share, in [0, 1], of a secant: a matrix with which the
  /// quadratic model of the term lies nowhere below its energy. A step begins without. False where the term has none, or nothing now
  /// that it would be of.
  virtual bool take_secant(double /*share*/) { return false; }
  /// The step has converged at the iterate x: what was taken from its start is taken from there, and the step goes on, if true.
  virtual bool renew_lagged_state(const PositionsView& /*x*/) { return false; }
  /// The step is over and ended at x.
  virtual void end_step(const PositionsView& /*x*/, PhaseClock&) {}
  /// What it remembers from step to step (core/base/archive). A term that begin_step makes anew has nothing.
  virtual void keep(Archive&) {}

  // --- an iterate
  /// Every term has accepted x, or begun its step there, and is linearised next: what is taken of other terms anew at every iterate.
  virtual void begin_iterate(const PositionsView& /*x*/) {}
  /// Adds to the free columns of `force` (N) how this term's gradient changes, to first order, when
  /// prescribed vertices move by `motion` (m, 0 at free vertices), as far as it is in no block of the matrix.
  virtual void add_given_motion(const PositionsView& /*x*/, const PositionsView& /*motion*/,
                                PositionsSpan /*force*/) {}

  // --- a motion
  /// Before bound() and trials along it.
  virtual void prepare(const Motion&, PhaseClock&) {}
  /// What bound() reads is launched: for all terms before it is read of one.
  virtual void look_along(const Motion&, PhaseClock&) {}
  /// Largest alpha in [0, 1] up to which the motion is feasible, after look_along(). Says it in the report too.
  virtual double bound(const Motion&, IterateNumbers&, PhaseClock&) { return 1; }
  /// Of a motion dx from x that bound() ends at `bound`, prescribed vertices at rest: adds to `force` (N) what
  /// corrects for gaps that are curved along it (core/contact/gap_along.hpp). Whether curvature is what holds it.
  virtual bool add_curvature_correction(const PositionsView& /*x*/, const PositionsView& /*dx*/,
                                        double /*bound*/, PositionsSpan /*force*/) {
    return false;
  }
  /// What held the last bound() below 1.
  virtual std::string describe_bound() const { return {}; }

  // --- a step that is proven when it is over (docs/theory/contact-models.md, Collision choice)
  /// Whether bound() holds for pairs too that a step is proven for when it is over.
  virtual void bound_audited(bool /*bound*/) {}
  /// How far the straight motion of the whole step, x_n to the iterate x, is proven free of what passes
  /// through in these pairs.
  virtual StepBound prove_step(const PositionsView& /*x_n*/, const PositionsView& /*x*/, PhaseClock&) {
    return {};
  }

  // --- a trial state, of the iterate x
  /// Whether is_feasible() refuses a trial with a number that is not finite.
  virtual bool sees_non_finite() const { return false; }
  /// What is_feasible() reads is launched: for all terms before it is read of one.
  virtual void look_at(const PositionsView& /*x*/, const PositionsView& /*trial*/, PhaseClock&) {}
  /// Whether the trial is feasible, after look_at().
  virtual bool is_feasible(const PositionsView& /*trial*/, PhaseClock&) { return true; }
  /// All terms admit the trial: what it brings that the rest of the step keeps, like the kappa of pairs that turn up.
  virtual void freeze(PhaseClock&) {}
  /// Energies at the trial, after freeze(), where they are requested. What changes with the iterate only, like kappa, stays
  /// as it is.
  virtual void evaluate(const PositionsView& trial) = 0;
  /// The trial becomes the iterate. take_energies() comes next where it was evaluated.
  virtual void accept(PhaseClock&) {}
  /// The energies of the trial are those of the iterate.
  virtual void take_energies() = 0;
  /// Energies of the iterate x, which was accepted without them.
  virtual void evaluate_iterate(const PositionsView& x) {
    evaluate(x);
    take_energies();
  }

  // --- what is reported of it, at the iterate x
  /// What report() reads is launched.
  virtual void announce(const PositionsView& /*x*/) {}
  virtual void report(const PositionsView& /*x*/, IterateNumbers&, PhaseClock&) {}
  virtual void report_end(const PositionsView& /*x*/, StepNumbers&, PhaseClock&) {}
};

}  // namespace bb
