// What is read of a NewtonSystem.
#pragma once

#include "core/newton/newton_state.hpp"
#include "core/newton/step_view.hpp"

namespace bb {

class StepSystem;

class NewtonView final : public StepView {
 public:
  /// Of `system`, whose state it is; both must outlive the view.
  NewtonView(StepSystem& system, NewtonState& state) : system_(system), state_(state) {}
  /// The iterate has changed, and with it the gradient; the gradient alone.
  void forget();
  void forget_gradient() { gradient_.valid = state_.gradient_seen = false; }

  const Scene& scene() const override { return state_.scene; }
  Precision precision() const override { return state_.precision; }
  const std::vector<std::uint8_t>& fixed() const override { return state_.fixed; }
  int n_free() const override { return state_.n_free; }

  PositionsView x() const override { return host(state_.x, x_); }
  PositionsView x_before() const override { return host(state_.trial, before_); }
  PositionsView gradient() const override { return host(state_.g, gradient_); }
  double grad_inf() const override;
  bool at_target() const override { return state_.first_short_pin() < 0; }

  double energy() const override { return state_.potential->energy(TermSet::all(), state_.x); }
  double energy(TermGroup group) const override { return state_.potential->energy(group, state_.x); }
  bool pattern_changed() const override { return state_.potential->pattern_changed(); }
  std::size_t nnz() const override { return state_.potential->nnz(); }

  void announce() const override;
  void report(IterateNumbers& out) const override { state_.potential->report(state_.x, out); }
  void report_end(StepNumbers& out) const override { state_.potential->report_end(state_.x, out); }
  void report_overload(bool with_direction, StepNumbers& out) const override;
  std::string describe_bound() const override { return state_.potential->describe_bound(); }
  std::string describe_non_finite() const override;

 private:
  /// A column on the host, copied when it is requested.
  struct HostCopy {
    Positions values;
    bool valid = false;
  };
  PositionsView host(const Column& column, HostCopy& to) const;

  StepSystem& system_;
  NewtonState& state_;
  mutable HostCopy x_, before_, gradient_;
};

}  // namespace bb
