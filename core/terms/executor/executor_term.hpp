// A term of E as the matrix engine of an executor reads it: it adds its gradient and its Hessian where they are summed. It is made by
// make_executor_<name>, the name that of its line in core/terms/registry.inc; by add_lagged() where that is LAGGED.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/energy/families/element_kernels.hpp"
#include "core/exec/buffer.hpp"
#include "core/exec/sums/executor_sum.hpp"
#include "core/linear/executor/executor_matrix.hpp"
#include "core/terms/executor/load_kernels.hpp"
#include "core/terms/term.hpp"

namespace bb {
struct KnownStep;
}  // namespace bb

namespace bb::exec {

/// [3 n_vertices] of the executor.
using Column = Buffer<double>;
struct ExpectedContacts;

/// What a term may read while it is linearised.
struct ExecutorContext {
  MatrixPart
      elastic;     // both triangles of H at the iterate; its values only where the plan has policy_submatrix
  Index n_blocks;  // of it
  PhaseClock& clock;
};

/// Energies of terms whose elements stay, one column after the other; several terms are one launch.
template <class Lead>
class EnergySeries {
 public:
  explicit EnergySeries(ExecutorSum& sum) : sum_(sum) {}
  /// The loads, before anything else.
  void lead(Index n, const Lead& lead) { series_.lead = lead, series_.n_lead = n; }
  /// from: null where the column itself is summed.
  void add(Index n, const double* from, const double* to) { add_column({n, from, to, false}); }
  /// Parts that have their magnitude beside them.
  void add_parts(Index n, const double* part, const double* magnitude) {
    add_column({n, part, magnitude, true});
  }
  void launch() {
    sum_.add(series_);
    series_ = {};
  }

 private:
  void add_column(const SeriesColumn& column) {
    if (series_.n_columns == SumSeries<Lead>::most_columns) launch();
    series_.column[series_.n_columns++] = column;
  }

  ExecutorSum& sum_;
  SumSeries<Lead> series_{};
};
/// E(trial) - E(iterate) of elements that stay: compared one by one.
using ExecutorChange = EnergySeries<LoadChanges>;
using ExecutorEnergy = EnergySeries<LoadEnergies>;

/// Energies, J, where rows come and go: compared as sums.
struct RowEnergies {
  Compensated before = Compensated::zero(), after = Compensated::zero();
};

/// The matrix of a term whose stencils come and go, both triangles.
struct ChangingMatrix {
  MatrixPart part{};
  Index n_blocks = 0;
};

class ExecutorTerm : public Term {
 public:
  /// Forgets the pattern of a matrix that comes and goes: between steps.
  virtual void drop_caches() {}

  // --- an iterate x
  /// Energies and gradient at x; g (N), the gradient of the terms before, gets that of this term.
  virtual void linearise(const PositionsView& x, const ExecutorContext& context, PositionsSpan g) = 0;
  /// Adds its Hessian to the matrix of fixed stencils, or makes its own. After linearise(x).
  virtual void add_matrix(const PositionsView& /*x*/, const HessianRequest&) {}
  /// Null where stencils stay. Valid until the next add_matrix() or prepare().
  virtual ChangingMatrix changing_matrix() const { return {}; }
  /// Whether the last linearise() made another pattern of that.
  virtual bool pattern_changed() const { return false; }

  // --- sums
  virtual void add_change(const PositionsView& x, const PositionsView& trial, ExecutorChange& out) = 0;
  /// Adds what add_change() launched besides.
  virtual void add_rows(RowEnergies&) {}
  void take_energies() override {}
  virtual void add_energy(const PositionsView& x, ExecutorEnergy& out) = 0;
  /// What add_energy() launched besides, J.
  virtual Compensated row_energy() { return Compensated::zero(); }
  /// First element with an energy that is not finite; -1 without one.
  virtual Index first_not_finite(ExecutorLeast&) { return -1; }
  /// What is frozen for the step, for the copy on the host.
  virtual void add_known(KnownStep&) const {}

  // --- memory
  /// What an executor that only counts buffers is to take the contacts for.
  virtual void expect(const ExpectedContacts&) {}
  /// From so many rows on, what a stage does not read is given back before it. Results do not depend on it.
  virtual void set_frugal_from(Index /*rows*/) {}
  /// Bytes that lists of candidates may take. Results do not depend on it.
  virtual void set_list_budget(std::size_t /*bytes*/) {}
};

}  // namespace bb::exec
