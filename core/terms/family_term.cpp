#include "core/terms/family_term.hpp"

#include "core/terms/cusps.hpp"

namespace bb {

FamilyTerm::FamilyTerm(std::string_view name, TermGroup group, std::unique_ptr<ElementFamily> family)
    : FamilySteps(name, group, std::move(family)) {
  const auto n = static_cast<std::size_t>(family_->size());
  TermFamily& out = families_.emplace_back();
  out.stencils = {family_->width(), family_->vertices()};
  out.local.resize(n, family_->width(), family_->has_hessian());
  out.trial_energy.resize(n);
}

void FamilyTerm::change(const PositionsView& x0, const PositionsView& x1, EnergyParts& out) const {
  if (!family_->has_changes()) return HostTerm::change(x0, x1, out);
  const std::size_t start = out.size();
  out.resize(start + size());
  EnergyPart* const parts = out.data() + start;
  family_->changes(x0.data(), x1.data(), &parts->change, &parts->magnitude,
                   sizeof(EnergyPart) / sizeof(double));
}

void FamilyTerm::add_cusps(const PositionsView& x, Cusps& out) const { out.add(name(), *family_, x); }

}  // namespace bb
