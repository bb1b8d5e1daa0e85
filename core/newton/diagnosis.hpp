// Terms and matrices of the iterate on the host, for observers: condition numbers, dumps, eigenvectors, calibration runs. Nothing
// here is needed for a step.
#pragma once

#include <functional>
#include <span>

#include "core/linear/block_system.hpp"
#include "core/newton/report.hpp"
#include "core/terms/host_term.hpp"

namespace bb {

class HostEngine;
struct NewtonState;

class Diagnosis {
 public:
  /// Of an assembled iterate; both must outlive it.
  Diagnosis(HostEngine& potential, NewtonState& state) : potential_(potential), state_(state) {}

  const Scene& scene() const;
  /// The iterate [3 x n] m, and the gradient of E there, N.
  PositionsView x() const;
  PositionsView gradient() const;
  /// The start of the step [3 x n] m.
  PositionsView x_n() const;
  /// The direction that was found or set last [3 x n] m.
  PositionsView direction() const;
  const TermList& terms() const;
  const BlockSystem& blocks() const;
  /// Whether a group has elements at the iterate.
  bool active(TermGroup group) const;

  // --- matrices without eliminated degrees of freedom; each is valid until the next call of any of these
  /// The one that was solved last.
  const ReducedSystem& solved();
  /// That of some terms with every element clamped. Cost: an assembly, and the clamped elements if no attempt
  /// needed them.
  const ReducedSystem& clamped(TermSet set = TermSet::all());
  /// That of all terms with the Hessian that each begins with: the exact one where its choice has it. Cost: an assembly.
  const ReducedSystem& exact();
  /// clamped() with eliminated degrees of freedom.
  const BlockSystem::Values& clamped_values(TermSet set);
  /// Calls visit for every family of the set's terms that has Hessians, with those that clamped(set) sums: lower blocks,
  /// element by element. Cost: the clamped elements if no attempt needed them.
  using VisitHessians =
      std::function<void(const HostTerm& term, std::size_t family, std::span<const double> hess)>;
  void visit_clamped(TermSet set, const VisitHessians& visit);

  /// Right-hand side of the system that was set up last, with what prescribed motion adds; free degrees of freedom.
  const VecXd& rhs();
  /// Whether no element of the solved matrix was clamped that its choice begins with exact.
  bool solved_is_exact() const;
  /// Whether the solved matrix is the clamped one: no term began with another Hessian, or the last attempt clamped all.
  bool solved_is_clamped() const;
  /// StepView::report_overload with the direction that there is.
  void report_overload(StepNumbers& out);

 private:
  HostEngine& potential_;
  NewtonState& state_;
  VecXd rhs_;
};

}  // namespace bb
