#include "core/resident/elements/family_term.hpp"

#include "core/energy/families/families.hpp"
#include "core/resident/elements/element_terms.hpp"
#include "core/terms/part_term.hpp"

namespace bb::resident {

FamilyTerm::FamilyTerm(const ResidentInputs& inputs, std::string_view name, TermGroup group,
                       const ElementFamily& elements, std::unique_ptr<ElementFamily>&& family)
    : FamilySteps(name, group, std::move(family), inputs, elements.width(), elements.vertices()),
      change_(inputs.executor, std::string(name) + " changes", family_->has_changes() ? 2 * size() : 0) {}

void FamilyTerm::add_change(const PositionsView& x, const PositionsView& trial, ResidentChange& out) {
  if (!family_->has_changes()) return ElementTerm::add_change(x, trial, out);
  double* const magnitude = change_.data() + size();
  family_->changes(x.data(), trial.data(), change_.data(), magnitude, 1);
  out.add_parts(size(), change_.data(), magnitude);
}

void make_resident_part(const Part& part, const ResidentInputs& inputs, ExecutorTerms& terms) {
  std::vector<std::unique_ptr<ElementFamily>> families;
  part.add_families(inputs.scene, {inputs.executor}, families);
  for (auto& family : families) {
    terms.add(std::make_unique<FamilyTerm>(inputs, name_of(part), TermGroup::elastic, std::move(family)));
  }
}

void make_resident_stitch(const ResidentInputs& inputs, ExecutorTerms& terms) {
  terms.add(std::make_unique<FamilyTerm>(inputs, "stitch", TermGroup::elastic,
                                         stitch_family({inputs.executor}, inputs.scene.stitches)));
}
void make_resident_pull(const ResidentInputs& inputs, ExecutorTerms& terms) {
  terms.add(std::make_unique<FamilyTerm>(inputs, "pull", TermGroup::load,
                                         pull_family({inputs.executor}, inputs.scene)));
}
void make_resident_air_drag(const ResidentInputs& inputs, ExecutorTerms& terms) {
  terms.add(std::make_unique<FamilyTerm>(inputs, "air_drag", TermGroup::load,
                                         air_drag_family({inputs.executor}, inputs.scene)));
}
void make_resident_inflation(const ResidentInputs& inputs, ExecutorTerms& terms) {
  terms.add(std::make_unique<FamilyTerm>(inputs, "inflation", TermGroup::load,
                                         inflation_family({inputs.executor}, inputs.scene)));
}

}  // namespace bb::resident
