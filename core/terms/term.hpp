// A term of E, the incremental potential: what Newton knows of it (docs/design.md, Terms). A term is one file
// of this room and one line of registry.inc. It owns what it computes: local terms at the iterate, energies
// of the iterate and of the trial state.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/energy/constraint_batch.hpp"
#include "core/energy/families/family_step.hpp"
#include "core/energy/local_terms.hpp"
#include "core/energy/vertex_loads.hpp"
#include "core/linear/block_system.hpp"
#include "core/math/projection.hpp"
#include "core/math/types.hpp"
#include "core/record/phase_times.hpp"
#include "core/terms/list_of_terms.hpp"
#include "core/terms/report.hpp"
#include "core/terms/term_set.hpp"

namespace bb {

class Archive;
struct ContactLoads;
struct Cusps;
struct KnownStep;

/// One time step, the same for all terms. It outlives the step.
struct StepFrame {
  Positions x_n, x_tilde;  // [3 x n] m
  double dt = 0;           // s
  double c = 1;            // inertia weight M/(c dt^2); 0 when quasi-static
  double load_factor = 1;  // of the external force
  double t_end = 0;        // s, when the step is over: what is given as a function of time is taken there
  bool at_start = false;   // no step: forces at t_end, where a step of length dt begins
  FamilyStep of_families() const { return {x_n.data(), x_tilde.data(), dt, c, load_factor, t_end, at_start}; }
};

/// What a term may read of the others while it is linearised at an iterate.
struct TermContext {
  const BlockSystem& blocks;           // pattern of the iterate's matrix
  const BlockSystem::Values& elastic;  // H at the iterate; empty unless the plan has policy_submatrix
  PositionsView gradient;              // N, of the terms before this one
  Projection projection;               // of the Hessian of every element
  PhaseClock& clock;
};

/// Straight motion of a whole step: x0 -> x1, x1 - x0 = dx up to rounding; x1 is exact
/// at prescribed vertices.
struct Motion {
  PositionsView x0, x1, dx;
  bool to_bound = false;  // no state beyond what bound() allows will be tried
};

/// Elements of one shape: who they touch, and what they are at the iterate.
struct TermFamily {
  Stencils stencils;
  LocalTerms local;                  // hess stays empty where a term has no Hessian
  LocalTerms clamped;                // what clamp() fills; only its hess is read
  std::vector<double> trial_energy;  // [n elements of the trial state] J
};

/// What E changes by from the iterate to the trial, in parts that are summed one by one: a difference of
/// large sums would lose the decrease that the line search looks for.
using EnergyPart = ValueChange<double>;
using EnergyParts = std::vector<EnergyPart>;

/// Whether inequalities are rigid, or as compliant as the stiffness says that the term has.
enum class Inequalities { rigid, compliant };

/// What constraints are asked for, and what may be read for it.
struct ConstraintRequest {
  PositionsView x;  // [3 x n] m, where those that come and go are found
  Inequalities inequalities;
  const BlockSystem& blocks;
  const BlockSystem::Values& elastic;  // H, as in TermContext
  PhaseClock& clock;
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

  // --- structure
  /// One entry a kind of element, always as many, in a fixed order.
  std::span<const TermFamily> families() const { return families_; }
  /// Elements of the iterate.
  std::size_t size() const;
  /// False when elements come and go: their stencils are read anew at every iterate, and their gradient is
  /// summed by itself before it is added to that of the other terms.
  virtual bool fixed_stencils() const { return true; }
  /// True when the elements are the vertices: the energies of such terms are summed vertex by vertex.
  virtual bool on_vertices() const { return false; }

  // --- a step
  /// A step from frame.x_n begins: it is the iterate now, and what belongs to the step before is forgotten.
  virtual void begin_step(const StepFrame& frame, PhaseClock&) { change_frame(frame); }
  /// The same step and iterate with another prediction and length.
  virtual void change_frame(const StepFrame&) {}
  /// What this step has frozen in another system, whose state is looked at.
  virtual void adopt(const KnownStep&) {}
  /// The same of that system's own term, which is of the same class.
  virtual void adopt_from(const Term&) {}
  /// The step has converged at the iterate x: what was taken from its start is taken from there, and the step goes on, if true.
  virtual bool renew_lag(const PositionsView& /*x*/) { return false; }
  /// The step is over and ended at x.
  virtual void end_step(const PositionsView& /*x*/, PhaseClock&) {}
  /// What it remembers from step to step (core/archive). A term that begin_step makes anew has nothing.
  virtual void keep(Archive&) {}

  // --- an iterate
  /// Energies, gradients and Hessians of all families at the iterate x. Elastic terms come first and read of
  /// the context only the projection; convex terms (registry.inc) need none.
  virtual void linearise(const PositionsView& x, const TermContext& context) = 0;
  /// Fills `clamped` of all families with the Hessians of the same iterate under Projection::psd. Convex
  /// terms have nothing to do.
  virtual void clamp(const PositionsView& /*x*/) {}
  /// Adds to the free columns of `force` (N) how this term's gradient changes, to first order, when
  /// prescribed vertices move by `motion` (m, 0 at free vertices), as far as it is in no block of the matrix.
  virtual void add_given_motion(const PositionsView& /*x*/, const PositionsView& /*motion*/,
                                PositionsSpan /*force*/) const {}

  /// Appends the contacts that this term holds at the iterate x, with their loads once it is linearised there. Terms of later
  /// lines, which are handed it when they are made, read them at the start of a step: friction, restitution.
  virtual void add_loads(const PositionsView& /*x*/, ContactLoads& /*out*/) const {}

  // --- a motion
  /// Before bound() and trials along it.
  virtual void prepare(const Motion&, PhaseClock&) {}
  /// Largest alpha in [0, 1] up to which the motion is feasible. Says it in the report too.
  virtual double bound(const Motion&, IterateNumbers&, PhaseClock&) { return 1; }
  /// What the last bound() was the smallest of, where each vertex has a bound of its own: [n] the part of its motion that
  /// each may go, whatever part the others do. Empty where one part serves all.
  virtual std::span<const double> vertex_parts() const { return {}; }
  /// Of a motion dx [3 x n] (m) from x that bound() ends at `bound`, prescribed vertices at rest: adds to `force` (N) what
  /// makes room for gaps that are curved along it (core/contact/gap_along.hpp). Whether curvature is what holds it.
  virtual bool add_detour(const PositionsView& /*x*/, const PositionsView& /*dx*/, double /*bound*/,
                          PositionsSpan /*force*/) const {
    return false;
  }
  /// What held the last bound() below 1.
  virtual std::string describe_bound() const { return {}; }

  // --- a trial state x, every number of it finite
  /// Whether x is feasible.
  virtual bool admits(const PositionsView& /*x*/, PhaseClock&) { return true; }
  /// All terms admit the trial: what it brings that the rest of the step keeps, like the kappa of pairs that turn up.
  /// elastic: H at the iterate, as in TermContext.
  virtual void freeze(const BlockSystem& /*blocks*/, const BlockSystem::Values& /*elastic*/, PhaseClock&) {}
  /// Energies at the trial, after freeze(), where they are asked for. What changes with the iterate only, like kappa, stays
  /// as it is.
  virtual void evaluate(const PositionsView& x) = 0;
  /// The parts of E(trial x1) - E(iterate x0), in the order of the elements. Appends.
  virtual void change(const PositionsView& x0, const PositionsView& x1, EnergyParts& out) const;
  /// The trial becomes the iterate. take_energies() comes next where it was evaluated.
  virtual void accept(PhaseClock&) {}
  /// The energies of the trial are those of the iterate.
  void take_energies();
  /// Energies of the iterate x, which was accepted without them.
  virtual void evaluate_iterate(const PositionsView& x);

  // --- constraints, for a step solver that asks for them in the place of all above, but for loads of vertices
  /// Whether constraints stand for this term.
  virtual bool offers_constraints() const { return false; }
  /// Appends them: always as many batches in the same order, which stay the term's, until the next call.
  virtual void add_constraints(const ConstraintRequest&, std::vector<const ConstraintBatch*>& /*out*/) {}

  // --- what is said of it, at the iterate x
  /// Adds its elements with a cusp.
  virtual void add_cusps(const PositionsView& /*x*/, Cusps& /*out*/) const {}
  virtual void report(const PositionsView& /*x*/, IterateNumbers&, PhaseClock&) {}
  virtual void report_end(const PositionsView& /*x*/, StepNumbers&, PhaseClock&) {}
  /// How many times the largest force of a bounded barrier the loads of a step without progress are. others:
  /// gradient of all other terms at the iterate x. dx: the Newton direction there, or 0.
  virtual void report_overload(const PositionsView& /*x*/, const PositionsView& /*others*/,
                               const PositionsView& /*dx*/, StepNumbers&) {}

 protected:
  /// The parts of a family whose elements are the same at the iterate and at the trial: one an element. Appends.
  static void compare_elements(const TermFamily& family, EnergyParts& out);

  std::vector<TermFamily> families_;
};

using TermList = ListOfTerms<Term>;

}  // namespace bb
