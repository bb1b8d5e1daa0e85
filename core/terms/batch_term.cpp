#include "core/terms/batch_term.hpp"

namespace bb {

BatchTerm::BatchTerm(std::string_view name, std::unique_ptr<EnergyBatch> batch)
    : name_(name), batch_(std::move(batch)) {
  TermFamily& family = families_.emplace_back();
  family.stencils = {batch_->width(), batch_->vertices()};
  family.local.resize(batch_->size(), batch_->width());
  family.trial_energy.resize(batch_->size());
}

}  // namespace bb
