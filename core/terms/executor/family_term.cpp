#include "core/terms/executor/family_term.hpp"

#include "core/energy/families/families.hpp"
#include "core/terms/executor/element_terms.hpp"
#include "core/terms/part_term.hpp"

namespace bb::exec {

FamilyTerm::FamilyTerm(const ExecutorInputs& inputs, std::string_view name, TermGroup group,
                       const ElementFamily& elements, std::unique_ptr<ElementFamily>&& family)
    : FamilySteps(name, group, std::move(family), inputs, elements.width(), elements.vertices()),
      change_(inputs.executor, std::string(name) + " changes", family_->has_changes() ? 2 * size() : 0) {}

void FamilyTerm::add_change(const PositionsView& x, const PositionsView& trial, ExecutorChange& out) {
  if (!family_->has_changes()) return ElementTerm::add_change(x, trial, out);
  double* const magnitude = change_.data() + size();
  family_->changes(x.data(), trial.data(), change_.data(), magnitude, 1);
  out.add_parts(size(), change_.data(), magnitude);
}

void make_part_on_executor(const Part& part, const ExecutorInputs& inputs, ExecutorTerms& terms) {
  std::vector<std::unique_ptr<ElementFamily>> families;
  part.add_families(inputs.scene, {inputs.executor}, families);
  for (auto& family : families) {
    terms.add(std::make_unique<FamilyTerm>(inputs, name_of(part), TermGroup::elastic, std::move(family)));
  }
}

void make_stitch_on_executor(const ExecutorInputs& inputs, ExecutorTerms& terms) {
  terms.add(std::make_unique<FamilyTerm>(inputs, "stitch", TermGroup::elastic,
                                         stitch_family({inputs.executor}, inputs.scene.stitches)));
}
void make_pull_on_executor(const ExecutorInputs& inputs, ExecutorTerms& terms) {
  terms.add(std::make_unique<FamilyTerm>(inputs, "pull", TermGroup::load,
                                         pull_family({inputs.executor}, inputs.scene)));
}
void make_air_drag_on_executor(const ExecutorInputs& inputs, ExecutorTerms& terms) {
  terms.add(std::make_unique<FamilyTerm>(inputs, "air_drag", TermGroup::load,
                                         air_drag_family({inputs.executor}, inputs.scene)));
}
void make_inflation_on_executor(const ExecutorInputs& inputs, ExecutorTerms& terms) {
  terms.add(std::make_unique<FamilyTerm>(inputs, "inflation", TermGroup::load,
                                         inflation_family({inputs.executor}, inputs.scene)));
}

}  // namespace bb::exec
