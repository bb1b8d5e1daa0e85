// What a term of one family of elements does in a step, whichever matrix engine reads it.
#pragma once

#include <memory>
#include <string_view>
#include <utility>

#include "core/energy/families/element_family.hpp"
#include "core/terms/term.hpp"

namespace bb {

/// Base: a term of a matrix engine with trial_energies(), which points to as many numbers (J) as there are elements.
template <class Base>
class FamilySteps : public Base {
 public:
  std::string_view name() const override { return name_; }
  TermGroup group() const override { return group_; }
  Phase phase() const override { return phase_of(group_); }
  void begin_step(const StepColumns& step, PhaseClock&) override {
    dt_ = step.dt;
    family_->begin_step(step.of_families());
  }
  void change_step(const StepColumns& step) override {
    dt_ = step.dt;
    family_->change_step(step.of_families());
  }
  void end_step(const PositionsView& x, PhaseClock& clock) override {
    if (!family_->flows()) return;
    const ScopedPhase timer(clock, Phase::elastic);
    family_->end_step(x.data(), dt_);
  }
  void report_end(const PositionsView& x, StepNumbers& out, PhaseClock& clock) override {
    if (!family_->flows()) return;
    const ScopedPhase timer(clock, Phase::elastic);
    if (const auto broken = family_->broken(x.data())) out.broken_stitches = static_cast<long long>(*broken);
  }
  void keep(Archive& archive) override { family_->keep(archive); }
  void evaluate(const PositionsView& trial) override {
    family_->values(trial.data(), this->trial_energies());
  }

 protected:
  /// name: that of registry.inc. group: load or elastic.
  template <class... OfBase>
  FamilySteps(std::string_view name, TermGroup group, std::unique_ptr<ElementFamily> family,
              OfBase&&... of_base)
      : Base(std::forward<OfBase>(of_base)...), family_(std::move(family)), name_(name), group_(group) {}

  std::unique_ptr<ElementFamily> family_;

 private:
  std::string_view name_;
  TermGroup group_;
  double dt_ = 0;  // s, of the step
};

}  // namespace bb
