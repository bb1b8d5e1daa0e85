#include "core/resident/elements/family_term.hpp"

#include "core/energy/families/families.hpp"
#include "core/resident/elements/element_terms.hpp"
#include "core/terms/part_term.hpp"

namespace bb::resident {

FamilyTerm::FamilyTerm(const ResidentInputs& inputs, std::string_view name,
                       std::unique_ptr<ElementFamily> family)
    : ElementTerm(inputs, name, TermGroup::elastic, Phase::elastic, family->width(), family->vertices()),
      family_(std::move(family)) {}

void FamilyTerm::begin_step(const ResidentFrame& frame) {
  family_->begin_step();
  change_frame(frame);
}

void FamilyTerm::change_frame(const ResidentFrame& frame) {
  dt_ = frame.dt;
  family_->set_time(frame.t_end);
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

void make_resident_part(const Part& part, const ResidentInputs& inputs, ResidentTermList& terms) {
  std::vector<std::unique_ptr<ElementFamily>> families;
  part.add_families(inputs.scene, {inputs.executor}, families);
  for (auto& family : families) {
    terms.add(std::make_unique<FamilyTerm>(inputs, name_of(part), std::move(family)));
  }
}

void make_resident_stitch(const ResidentInputs& inputs, ResidentTermList& terms) {
  terms.add(std::make_unique<FamilyTerm>(inputs, "stitch",
                                         stitch_family({inputs.executor}, inputs.scene.stitches)));
}

}  // namespace bb::resident
