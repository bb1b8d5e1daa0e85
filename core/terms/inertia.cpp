// Inertia: 1/(2 c h^2) |x - x_tilde|_M^2, one element a vertex.
#include "core/energy/families/families.hpp"
#include "core/terms/family_term.hpp"
#include "core/terms/registry.hpp"

namespace bb {

PlanItem needs_inertia(const TermNeeds& needs) {
  return plan_item(!needs.scene.mass.empty(), "vertices have mass", "no vertex");
}

void make_inertia(const TermInputs& inputs, TermList& terms) {
  terms.add(std::make_unique<FamilyTerm>("inertia", TermGroup::load,
                                         inertia_family({inputs.executor}, inputs.scene)));
}

}  // namespace bb
