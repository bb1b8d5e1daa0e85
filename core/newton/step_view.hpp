// What is read of a step system: its state, and what the terms report of it. Nothing here changes a step.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/math/precision.hpp"
#include "core/model/scene/scene.hpp"
#include "core/newton/report.hpp"
#include "core/terms/term_set.hpp"

namespace bb {

class StepView {
 public:
  virtual ~StepView() = default;

  virtual const Scene& scene() const = 0;
  virtual Precision precision() const = 0;
  /// [3 n] prescribed or locked degrees of freedom, and how many are neither.
  virtual const std::vector<std::uint8_t>& fixed() const = 0;
  virtual int n_free() const = 0;

  // --- vectors [3 x n]; valid until the next call that changes the state. Elsewhere than on the host a call copies them
  /// The iterate, and the one before the last accept(), m.
  virtual PositionsView x() const = 0;
  virtual PositionsView x_before() const = 0;
  /// Of E at the iterate, N.
  virtual PositionsView gradient() const = 0;
  /// Largest |gradient| over free degrees of freedom, N.
  virtual double grad_inf() const = 0;
  /// Whether every prescribed vertex is where directions lead it.
  virtual bool at_target() const = 0;

  // --- E at the iterate, J; for the record only
  virtual double energy() const = 0;
  virtual double energy(TermGroup group) const = 0;

  // --- the matrix
  virtual bool pattern_changed() const = 0;
  /// Entries of the lower triangle that was solved last.
  virtual std::size_t nnz() const = 0;

  // --- reports
  /// energy(), grad_inf() and report() will be called on the assembled iterate: what they need is launched, so that all of
  /// it is read at once. Results do not depend on it.
  virtual void announce() const {}
  /// What the terms report of the iterate, and of the end of a step.
  virtual void report(IterateNumbers& out) const = 0;
  virtual void report_end(StepNumbers& out) const = 0;
  /// Of a step without progress. with_direction: the Newton direction at the iterate is known, else it counts as 0.
  virtual void report_overload(bool with_direction, StepNumbers& out) const = 0;
  /// What held the last bound; empty where nothing did.
  virtual std::string describe_bound() const = 0;
  /// Where NaN or infinite numbers began.
  virtual std::string describe_non_finite() const = 0;
};

}  // namespace bb
