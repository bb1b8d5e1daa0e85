#include "core/terms/family_term.hpp"

#include "core/terms/cusps.hpp"

namespace bb {

FamilyTerm::FamilyTerm(std::string_view name, std::unique_ptr<ElementFamily> family)
    : name_(name), family_(std::move(family)) {
  const auto n = static_cast<std::size_t>(family_->size());
  TermFamily& out = families_.emplace_back();
  out.stencils = {family_->width(), family_->vertices()};
  out.local.resize(n, family_->width());
  out.trial_energy.resize(n);
}

void FamilyTerm::begin_step(const StepFrame& frame, PhaseClock&) {
  family_->begin_step();
  change_frame(frame);
}

void FamilyTerm::change_frame(const StepFrame& frame) {
  dt_ = frame.dt;
  family_->set_time(frame.t_end);
}

void FamilyTerm::end_step(const PositionsView& x, PhaseClock& clock) {
  if (!family_->flows()) return;
  const ScopedPhase timer(clock, Phase::elastic);
  family_->end_step(x.data(), dt_);
}

void FamilyTerm::add_cusps(const PositionsView& x, Cusps& out) const { out.add(name_, *family_, x); }

}  // namespace bb
