// A term of E in an executor's memory: what the sum (ResidentPotential) knows of it. It is made by
// make_resident_<name>, the name that of its line in core/terms/registry.inc; what Term (core/terms/term.hpp) is on the host.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/energy/families/element_kernels.hpp"
#include "core/exec/buffer.hpp"
#include "core/exec/sums/resident_sum.hpp"
#include "core/linear/executor/resident_matrix.hpp"
#include "core/record/phase_times.hpp"
#include "core/resident/elements/load_kernels.hpp"
#include "core/terms/report.hpp"
#include "core/terms/term_set.hpp"

namespace bb {
class Archive;
struct KnownStep;
}  // namespace bb

namespace bb::resident {

using exec::Buffer;
/// [3 n_vertices] of the executor.
using Column = Buffer<double>;
struct ExpectedContacts;

/// One time step, the same for all terms. Columns (m) are valid for the step.
struct ResidentFrame {
  const Column *x_n = nullptr, *x_tilde = nullptr;   // start of the step and prediction
  double dt = 0, c = 1, load_factor = 1, t_end = 0;  // as in StepFrame
  bool at_start = false;
  FamilyStep of_families() const {
    return {x_n->data(), x_tilde->data(), dt, c, load_factor, t_end, at_start};
  }
};

/// x0 -> x1, x1 - x0 = dx up to rounding, m; x1 is exact at prescribed vertices.
struct ResidentMotion {
  const Column &x0, &x1, &dx;
};

/// What a term may read while it is linearised.
struct ResidentContext {
  MatrixPart
      elastic;     // both triangles of H at the iterate; its values only where the plan has policy_submatrix
  Index n_blocks;  // of it
  PhaseClock& clock;
};

/// Energies of terms whose elements stay, one column after the other; several terms are one launch.
template <class Lead>
class EnergySeries {
 public:
  explicit EnergySeries(ResidentSum& sum) : sum_(sum) {}
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

  ResidentSum& sum_;
  SumSeries<Lead> series_{};
};
/// E(trial) - E(iterate) of elements that stay: compared one by one.
using ResidentChange = EnergySeries<LoadChanges>;
using ResidentEnergy = EnergySeries<LoadEnergies>;

/// Energies, J, where rows come and go: compared as sums.
struct RowEnergies {
  Compensated before = Compensated::zero(), after = Compensated::zero();
};

/// The matrix of a term whose stencils come and go, both triangles.
struct ChangingMatrix {
  MatrixPart part{};
  Index n_blocks = 0;
};

class ResidentTerm {
 public:
  ResidentTerm() = default;
  ResidentTerm(const ResidentTerm&) = delete;
  ResidentTerm& operator=(const ResidentTerm&) = delete;
  virtual ~ResidentTerm() = default;

  virtual std::string_view name() const = 0;
  virtual TermGroup group() const = 0;
  /// What linearising is charged to.
  virtual Phase phase() const = 0;

  // --- a step
  /// A step from frame.x_n begins: it is the iterate now.
  virtual void begin_step(const ResidentFrame& frame) { change_frame(frame); }
  /// The same step and iterate with another prediction and length.
  virtual void change_frame(const ResidentFrame&) {}
  /// As Term::renew_lag.
  virtual bool renew_lag(const Column& /*x*/) { return false; }
  /// The step is over and ended at x.
  virtual void end_step(const Column& /*x*/, PhaseClock&) {}
  /// The sections of its lines of registry.inc, with what it remembers from step to step, as the host's terms keep them.
  virtual void keep(Archive& archive);
  /// Forgets the pattern of a matrix that comes and goes: between steps.
  virtual void drop_caches() {}

  // --- an iterate x
  /// Energies and gradient at x; g (N), the gradient of the terms before, gets that of this term.
  virtual void linearise(const Column& x, const ResidentContext& context, Column& g) = 0;
  /// Adds its Hessian to the matrix of fixed stencils, or makes its own. After linearise(x).
  virtual void add_matrix(const Column& /*x*/, const HessianRequest&) {}
  /// Null where stencils stay. Valid until the next add_matrix() or prepare().
  virtual ChangingMatrix changing_matrix() const { return {}; }
  /// Whether the last linearise() made another pattern of that.
  virtual bool pattern_changed() const { return false; }
  /// As Term::add_given_motion.
  virtual void add_given_motion(const Column& /*x*/, const Column& /*motion*/, Column& /*force*/) {}

  // --- a motion
  virtual void prepare(const ResidentMotion&, PhaseClock&) {}
  /// What bound() reads is launched: for all terms before it is read of one.
  virtual void look_along(const ResidentMotion&, PhaseClock&) {}
  /// As Term::bound; after look_along().
  virtual double bound(const ResidentMotion&, IterateNumbers&, PhaseClock&) { return 1; }
  /// What held the last bound() below 1.
  virtual std::string describe_bound() const { return {}; }
  /// As Term::add_detour; it may give values of matrices back.
  virtual bool make_room(const Column& /*x*/, const Column& /*dx*/, double /*bound*/, Column& /*force*/) {
    return false;
  }

  // --- a trial state; x: the iterate
  /// Whether admits() refuses a state with a number that is not finite.
  virtual bool sees_non_finite() const { return false; }
  /// What admits() reads is launched: for all terms before it is read of one.
  virtual void look_at(const Column& /*x*/, const Column& /*trial*/, PhaseClock&) {}
  virtual bool admits(const Column& /*x*/, const Column& /*trial*/, PhaseClock&) { return true; }
  /// All terms admit the trial: as Term::freeze.
  virtual void freeze() {}
  /// Energies at the trial, after freeze(), where they are asked for.
  virtual void evaluate(const Column& trial) = 0;
  virtual void add_change(const Column& x, const Column& trial, ResidentChange& out) = 0;
  /// Adds what add_change() launched besides.
  virtual void add_rows(RowEnergies&) {}
  /// The trial becomes the iterate. take_energies() comes next where it was evaluated.
  virtual void accept() {}
  /// The energies of the trial are those of the iterate.
  virtual void take_energies() {}
  /// Energies of the iterate x, which was accepted without them.
  virtual void evaluate_iterate(const Column& /*x*/) {}

  // --- what is said of it, at the iterate x
  virtual void add_energy(const Column& x, ResidentEnergy& out) = 0;
  /// What add_energy() launched besides, J.
  virtual Compensated row_energy() { return Compensated::zero(); }
  /// What report() reads is launched.
  virtual void announce(const Column& /*x*/) {}
  virtual void report(const Column& /*x*/, IterateNumbers&, PhaseClock&) {}
  virtual void report_end(const Column& /*x*/, StepNumbers&) {}
  /// First element with an energy that is not finite; -1 without one.
  virtual Index first_not_finite(ResidentLeast&) { return -1; }
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

}  // namespace bb::resident
