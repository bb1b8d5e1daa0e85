#include "core/newton/diagnosis.hpp"

#include <algorithm>

#include "core/newton/host_engine.hpp"
#include "core/newton/newton_state.hpp"

namespace bb {

const Scene& Diagnosis::scene() const { return state_.scene; }
PositionsView Diagnosis::x() const { return points(state_.x); }
PositionsView Diagnosis::gradient() const { return points(state_.g); }
PositionsView Diagnosis::x_n() const { return points(state_.x_n); }
PositionsView Diagnosis::direction() const { return points(state_.dx); }
const TermList& Diagnosis::terms() const { return potential_.terms_; }
const BlockSystem& Diagnosis::blocks() const { return *potential_.blocks_; }

bool Diagnosis::active(TermGroup group) const {
  return std::any_of(terms().begin(), terms().end(),
                     [group](const auto& term) { return term->group() == group && term->size() > 0; });
}

const ReducedSystem& Diagnosis::solved() { return potential_.reduced(); }

const ReducedSystem& Diagnosis::clamped(TermSet set) {
  return potential_.blocks_->reduce(clamped_values(set));
}

const ReducedSystem& Diagnosis::exact() {
  if (state_.secant) potential_.leave_secants(state_.x, state_.g);
  potential_.sum_exact();
  return potential_.blocks_->reduce(potential_.blocks_->values());
}

const BlockSystem::Values& Diagnosis::clamped_values(TermSet set) {
  potential_.sum_clamped(set);
  return potential_.blocks_->values();
}

void Diagnosis::visit_clamped(TermSet set, const VisitHessians& visit) {
  potential_.clamp(set);
  for (const HostEngine::Slot& slot : potential_.slots_) {
    if (!set.has(slot.term->group())) continue;
    const std::span<const TermFamily> families = slot.term->families();
    for (std::size_t i = 0; i < families.size(); ++i) {
      if (families[i].local.hess.empty()) continue;
      visit(*slot.term, i, HostEngine::clamped_hessians(slot, families[i]));
    }
  }
}

const VecXd& Diagnosis::rhs() {
  potential_.blocks_->restrict_vector(points(state_.b), rhs_);
  return rhs_;
}

bool Diagnosis::solved_is_exact() const { return state_.level.exact() && !state_.secant; }
bool Diagnosis::solved_is_clamped() const { return state_.level.all_clamped() && state_.shift == 0; }

void Diagnosis::report_overload(StepNumbers& out) {
  potential_.report_overload(state_.x, state_.g, state_.dx, out);
}

}  // namespace bb
