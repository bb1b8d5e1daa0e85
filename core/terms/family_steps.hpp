// What a term of one family of elements does in a step, whichever matrix engine reads it.
#pragma once

#include <memory>
#include <utility>

#include "core/energy/families/element_family.hpp"
#include "core/terms/term.hpp"

namespace bb {

/// Base: a term of a matrix engine with energies() and trial_energies(), which point to as many numbers (J) as there are elements.
template <class Base>
class FamilySteps : public Base {
 public:
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
  void keep(Archive& archive) override { family_->keep(archive); }
  void evaluate(const PositionsView& trial) override {
    family_->values(trial.data(), this->trial_energies());
  }
  void evaluate_iterate(const PositionsView& x) override { family_->values(x.data(), this->energies()); }

 protected:
  template <class... OfBase>
  explicit FamilySteps(std::unique_ptr<ElementFamily> family, OfBase&&... of_base)
      : Base(std::forward<OfBase>(of_base)...), family_(std::move(family)) {}

  std::unique_ptr<ElementFamily> family_;

 private:
  double dt_ = 0;  // s, of the step
};

}  // namespace bb
