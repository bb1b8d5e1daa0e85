#include "core/resident/elements/family_term.hpp"

#include "core/energy/families/families.hpp"
#include "core/resident/elements/element_terms.hpp"
#include "core/terms/part_term.hpp"

namespace bb::resident {

FamilyTerm::FamilyTerm(const ResidentInputs& inputs, std::string_view name, TermGroup group,
                       std::unique_ptr<ElementFamily> family)
    : ElementTerm(inputs, name, group, phase_of(group), family->width(), family->vertices()),
      family_(std::move(family)),
      change_(inputs.executor, std::string(name) + " changes", family_->has_changes() ? 2 * size() : 0) {}

void FamilyTerm::begin_step(const ResidentFrame& frame) {
  dt_ = frame.dt;
  family_->begin_step(frame.of_families());
}

void FamilyTerm::change_frame(const ResidentFrame& frame) {
  dt_ = frame.dt;
  family_->change_step(frame.of_families());
}

void FamilyTerm::end_step(const Column& x, PhaseClock& clock) {
  if (!family_->flows()) return;
  const ScopedPhase timer(clock, Phase::elastic);
  family_->end_step(x.data(), dt_);
}

void FamilyTerm::keep(Archive& archive) {
  ResidentTerm::keep(archive);
  family_->keep(archive);
}

void FamilyTerm::add_change(const Column& x, const Column& trial, ResidentChange& out) {
  if (!family_->has_changes()) return ElementTerm::add_change(x, trial, out);
  double* const magnitude = change_.data() + size();
  family_->changes(x.data(), trial.data(), change_.data(), magnitude, 1);
  out.add_parts(size(), change_.data(), magnitude);
}

void make_resident_part(const Part& part, const ResidentInputs& inputs, ResidentTermList& terms) {
  std::vector<std::unique_ptr<ElementFamily>> families;
  part.add_families(inputs.scene, {inputs.executor}, families);
  for (auto& family : families) {
    terms.add(std::make_unique<FamilyTerm>(inputs, name_of(part), TermGroup::elastic, std::move(family)));
  }
}

void make_resident_stitch(const ResidentInputs& inputs, ResidentTermList& terms) {
  terms.add(std::make_unique<FamilyTerm>(inputs, "stitch", TermGroup::elastic,
                                         stitch_family({inputs.executor}, inputs.scene.stitches)));
}
void make_resident_pull(const ResidentInputs& inputs, ResidentTermList& terms) {
  terms.add(std::make_unique<FamilyTerm>(inputs, "pull", TermGroup::load,
                                         pull_family({inputs.executor}, inputs.scene)));
}
void make_resident_air_drag(const ResidentInputs& inputs, ResidentTermList& terms) {
  terms.add(std::make_unique<FamilyTerm>(inputs, "air_drag", TermGroup::load,
                                         air_drag_family({inputs.executor}, inputs.scene)));
}
void make_resident_inflation(const ResidentInputs& inputs, ResidentTermList& terms) {
  terms.add(std::make_unique<FamilyTerm>(inputs, "inflation", TermGroup::load,
                                         inflation_family({inputs.executor}, inputs.scene)));
}

}  // namespace bb::resident
