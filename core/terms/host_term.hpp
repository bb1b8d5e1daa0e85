// A term as the host's matrix engine reads it: local terms of elements side by side, which it scatters (docs/architecture.md, Terms).
#pragma once

#include <span>
#include <vector>

#include "core/energy/constraint_batch.hpp"
#include "core/energy/local_terms.hpp"
#include "core/energy/vertex_loads.hpp"
#include "core/linear/block_system.hpp"
#include "core/math/projection.hpp"
#include "core/terms/list_of_terms.hpp"
#include "core/terms/term.hpp"

namespace bb {

struct ContactForce;
struct ContactLoads;
struct Cusps;
struct KnownStep;

/// What a term may read of the others while it is linearised at an iterate.
struct TermContext {
  PositionsView gradient;  // N, of the terms before this one
  Projection projection;   // of the Hessian of every element
  PhaseClock& clock;
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

/// The requests to constraints, and what may be read for them.
struct ConstraintRequest {
  PositionsView x;  // [3 x n] m, where those that come and go are found
  Inequalities inequalities;
  PhaseClock& clock;
};

class HostTerm : public Term {
 public:
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
  /// What this step has frozen in another system, whose state is looked at.
  virtual void adopt(const KnownStep&) {}
  /// The same of that system's own term, which is of the same class.
  virtual void adopt_from(const HostTerm&) {}

  /// Where the pattern of the iterate's matrix is, and H at the iterate: empty unless the plan has policy_submatrix. Once; both outlive
  /// the term.
  void set_matrix(const BlockSystem& blocks, const BlockSystem::Values& elastic) {
    blocks_ = &blocks, elastic_ = &elastic;
  }

  // --- an iterate
  /// Energies, gradients and Hessians of all families at the iterate x. Elastic terms come first and read of
  /// the context only the projection; convex terms (registry.inc) need none.
  virtual void linearise(const PositionsView& x, const TermContext& context) = 0;
  /// Fills `clamped` of all families with the Hessians of the same iterate under Projection::psd. Convex
  /// terms have nothing to do.
  virtual void clamp(const PositionsView& /*x*/) {}

  /// Appends the contacts that this term holds at the iterate x, with their loads once it is linearised there. Terms of later
  /// lines, which are handed it when they are made, read them at the start of a step: friction, restitution.
  virtual void add_loads(const PositionsView& /*x*/, ContactLoads& /*out*/) const {}

  /// Appends what the contacts of the end x of a step, which began at x_n, do to each vertex there, prescribed ones too: the rows as
  /// the last iterate left them. Requires energies of x.
  virtual void add_forces(const PositionsView& /*x*/, const PositionsView& /*x_n*/,
                          std::vector<ContactForce>& /*out*/) const {}

  /// What the last bound() was the smallest of, where each vertex has a bound of its own: [n] the part of its motion that
  /// each may go, whatever part the others do. Empty where one part serves all.
  virtual std::span<const double> vertex_parts() const { return {}; }

  // --- energies
  /// The parts of E(trial x1) - E(iterate x0), in the order of the elements. Appends.
  virtual void change(const PositionsView& x0, const PositionsView& x1, EnergyParts& out) const;
  void take_energies() override;

  // --- constraints, for a step solver that requests them in the place of all above, but for loads of vertices
  /// Whether constraints stand for this term.
  virtual bool offers_constraints() const { return false; }
  /// Appends them: always as many batches in the same order, which stay the term's, until the next call.
  virtual void add_constraints(const ConstraintRequest&, std::vector<const ConstraintBatch*>& /*out*/) {}

  // --- what is reported of it, at the iterate x
  /// Adds its elements with a cusp.
  virtual void add_cusps(const PositionsView& /*x*/, Cusps& /*out*/) const {}
  /// How many times the largest force of a bounded barrier the loads of a step without progress are. others:
  /// gradient of all other terms at the iterate x. dx: the Newton direction there, or 0.
  virtual void report_overload(const PositionsView& /*x*/, const PositionsView& /*others*/,
                               const PositionsView& /*dx*/, StepNumbers&) {}

 protected:
  /// The parts of a family whose elements are the same at the iterate and at the trial: one an element. Appends.
  static void compare_elements(const TermFamily& family, EnergyParts& out);

  /// Of a term with one family.
  double* energies() { return families_[0].local.energy.data(); }
  double* trial_energies() { return families_[0].trial_energy.data(); }

  /// Of set_matrix(). Errors: std::logic_error before it.
  const BlockSystem& pattern() const {
    require_matrix();
    return *blocks_;
  }
  const BlockSystem::Values& elastic_values() const {
    require_matrix();
    return *elastic_;
  }

  std::vector<TermFamily> families_;

 private:
  void require_matrix() const;

  const BlockSystem* blocks_ = nullptr;
  const BlockSystem::Values* elastic_ = nullptr;
};

using TermList = ListOfTerms<HostTerm>;

}  // namespace bb
