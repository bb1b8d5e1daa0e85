// A term of elements that stay: one family (core/energy/families) in the host's memory.
#pragma once

#include "core/terms/family_steps.hpp"
#include "core/terms/host_term.hpp"

namespace bb {

class FamilyTerm final : public FamilySteps<HostTerm> {
 public:
  /// name: that of registry.inc. group: load or elastic.
  FamilyTerm(std::string_view name, TermGroup group, std::unique_ptr<ElementFamily> family);
  bool on_vertices() const override { return family_->on_vertices(); }
  void linearise(const PositionsView& x, const TermContext& context) override {
    family_->derivatives(x.data(), context.projection, families_[0].local);
  }
  void clamp(const PositionsView& x) override {
    family_->derivatives(x.data(), Projection::psd, families_[0].clamped);
  }
  void change(const PositionsView& x0, const PositionsView& x1, EnergyParts& out) const override;
  void add_cusps(const PositionsView& x, Cusps& out) const override;
  bool offers_constraints() const override { return family_->constraints() != nullptr; }
  void add_constraints(const ConstraintRequest&, std::vector<const ConstraintBatch*>& out) override {
    if (family_->constraints()) out.push_back(family_->constraints());
  }
};

}  // namespace bb
