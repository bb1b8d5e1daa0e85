// An elastic term whose mathematics is an EnergyBatch (core/energy).
#pragma once

#include "core/terms/term.hpp"

namespace bb {

class BatchTerm final : public Term {
 public:
  /// name: that of registry.inc.
  BatchTerm(std::string_view name, std::unique_ptr<EnergyBatch> batch);
  std::string_view name() const override { return name_; }
  TermGroup group() const override { return TermGroup::elastic; }
  Phase phase() const override { return Phase::elastic; }
  void begin_step(const StepFrame& frame, PhaseClock& clock) override;
  void change_frame(const StepFrame& frame) override;
  void end_step(const PositionsView& x, PhaseClock& clock) override;
  void keep(Archive& archive) override;
  void linearise(const PositionsView& x, const TermContext& context) override {
    batch_->derivatives(x, context.projection, families_[0].local);
  }
  void clamp(const PositionsView& x) override {
    batch_->derivatives(x, Projection::psd, families_[0].clamped);
  }
  void evaluate(const PositionsView& x) override { batch_->values(x, families_[0].trial_energy.data()); }
  void add_cusps(const PositionsView& x, Cusps& out) const override;
  bool offers_constraints() const override { return batch_->constraints() != nullptr; }
  void add_constraints(const ConstraintRequest&, std::vector<const ConstraintBatch*>& out) override {
    if (batch_->constraints()) out.push_back(batch_->constraints());
  }

 private:
  std::string_view name_;
  std::unique_ptr<EnergyBatch> batch_;
  double dt_ = 0;  // s, of the step
  std::vector<double>
      next_;  // memory of the batch from the next step on: whoever looks at a step that is over sees its own E
};

}  // namespace bb
