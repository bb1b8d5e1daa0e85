// What a term on lagged contacts does in a step, whichever matrix engine reads it.
#pragma once

#include <memory>
#include <string_view>
#include <utility>

#include "core/terms/lagged_family.hpp"
#include "core/terms/term.hpp"

namespace bb {

/// Base: a term of a matrix engine with trial_energies(), which points to as many numbers (J) as there are rows.
template <class Base>
class LaggedSteps : public Base {
 public:
  std::string_view name() const override { return name_; }
  TermGroup group() const override { return TermGroup::friction; }
  Phase phase() const override { return Phase::contact_terms; }

  void begin_step(const StepColumns& step, PhaseClock& clock) override {
    const ScopedPhase timer(clock, Phase::contact_terms);
    family_->begin_step(step.of_families());
    take_rows(step.x_n);
  }
  void change_step(const StepColumns& step) override { family_->change_step(step.of_families()); }
  void begin_iterate(const PositionsView& x) override {
    if (family_->loads_known() && family_->refreshes()) take_rows(x);
  }
  bool take_secant(double share) override { return family_->take_secant(share); }
  bool renew_lagged_state(const PositionsView& x) override {
    if (!family_->renews()) return false;
    const bool had_rows = family_->size() > 0;
    take_rows(x);
    return had_rows || family_->size() > 0;
  }
  void end_step(const PositionsView& x, PhaseClock&) override { family_->end_step(x.data()); }
  void keep(Archive& archive) override { family_->keep(archive); }
  void evaluate(const PositionsView& trial) override {
    family_->values(trial.data(), this->trial_energies());
  }
  void report_end(const PositionsView& x, StepNumbers& out, PhaseClock&) override {
    if (family_->loads_known())
      family_->report_end(x.data(), out);  // else rows were taken anew where it ended
  }

 protected:
  /// name: that of registry.inc.
  template <class... OfBase>
  LaggedSteps(std::string_view name, std::unique_ptr<LaggedFamily> family, OfBase&&... of_base)
      : Base(std::forward<OfBase>(of_base)...), name_(name), family_(std::move(family)) {}
  /// The rows become those of the contacts at x, without loads.
  virtual void take_rows(const PositionsView& x) = 0;

  std::string_view name_;
  std::unique_ptr<LaggedFamily> family_;
};

}  // namespace bb
