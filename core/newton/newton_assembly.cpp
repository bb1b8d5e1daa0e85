// Terms and gradient of the iterate, summed in the order that docs/design.md fixes. The matrix and its solve
// are in newton_matrix.cpp.
#include "core/newton/newton_system.hpp"

namespace bb {

void NewtonSystem::assemble() {
  for (Slot& slot : slots_) {
    if (slot.term->group() == TermGroup::elastic) linearise(slot);
  }
  {
    const ScopedPhase timer(clock(), Phase::assembly);
    pattern_changed_ = set_changing_families();
    gradient_.setZero(3, x_.cols());
  }
  if (plan_.policy_submatrix.needed) {
    sum_clamped(TermGroup::elastic);  // a stiffness policy reads a positive semi-definite H
    blocks_->take_values(elastic_);
  }
  for (Slot& slot : slots_) {
    if (slot.term->group() != TermGroup::elastic) linearise(slot);
    add_gradient(slot);
  }
  shift_ = 0;
  const double residual = largest_force();
  if (served_at_once_) level_.lower(residual);
  served_at_once_ = false;
  fill_matrix();
}

void NewtonSystem::linearise(Slot& slot) {
  const ScopedPhase timer(clock(), slot.term->phase());
  slot.term->linearise(x_, context(slot.hessian));
  slot.clamped = false;
}

bool NewtonSystem::set_changing_families() {
  std::vector<Stencils> families;
  for (const auto& term : terms_) {
    if (term->fixed_stencils()) continue;
    for (const TermFamily& family : term->families()) families.push_back(family.stencils);
  }
  return blocks_->set_contacts(std::move(families));
}

void NewtonSystem::add_families(const Slot& slot, Positions& gradient) const {
  std::size_t family = slot.first;
  for (const TermFamily& part : slot.term->families()) {
    if (slot.term->fixed_stencils()) {
      blocks_->gather_elements(family++, part.local.grad, gradient);
    } else {
      blocks_->gather_contacts(family++, part.local.grad, gradient);
    }
  }
}

// Elements that come and go are summed by themselves first.
void NewtonSystem::add_gradient(const Slot& slot) {
  const ScopedPhase timer(clock(), Phase::assembly);
  if (slot.term->fixed_stencils()) return add_families(slot, gradient_);
  part_.setZero(3, x_.cols());
  add_families(slot, part_);
  gradient_ += part_;
}

}  // namespace bb
