#include "core/terms/batch_term.hpp"

#include "core/archive/archive.hpp"
#include "core/terms/cusps.hpp"

namespace bb {

BatchTerm::BatchTerm(std::string_view name, std::unique_ptr<EnergyBatch> batch)
    : name_(name), batch_(std::move(batch)) {
  TermFamily& family = families_.emplace_back();
  family.stencils = {batch_->width(), batch_->vertices()};
  family.local.resize(batch_->size(), batch_->width());
  family.trial_energy.resize(batch_->size());
}

void BatchTerm::begin_step(const StepFrame& frame, PhaseClock&) {
  if (!next_.empty()) batch_->set_memory(next_);
  next_.clear();
  change_frame(frame);
}

void BatchTerm::change_frame(const StepFrame& frame) {
  dt_ = frame.dt;
  batch_->set_time(frame.t_end);
}

void BatchTerm::end_step(const PositionsView& x, PhaseClock& clock) {
  const std::span<const double> now = batch_->memory();
  if (now.empty()) return;
  const ScopedPhase timer(clock, Phase::elastic);
  next_.assign(now.begin(), now.end());
  batch_->flow(x, dt_, next_);
}

void BatchTerm::add_cusps(const PositionsView& x, Cusps& out) const { out.add(name_, *batch_, x); }

void BatchTerm::keep(Archive& archive) {
  const std::span<const double> now = batch_->memory();
  if (now.empty()) return;
  std::vector<double> memory(now.begin(), now.end());
  archive(memory, next_);
  if (archive.reads()) batch_->set_memory(memory);
}

}  // namespace bb
