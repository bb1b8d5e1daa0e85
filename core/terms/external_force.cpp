// Work of the weight: -f . (x - x_n), one element a vertex. No Hessian.
#include <algorithm>

#include "core/energy/families/families.hpp"
#include "core/terms/family_term.hpp"
#include "core/terms/registry.hpp"

namespace bb {

PlanItem needs_external_force(const TermNeeds& needs) {
  const Scene& scene = needs.scene;
  const bool some =
      !scene.gravity.isZero(0) || std::any_of(scene.gravity_keys.begin(), scene.gravity_keys.end(),
                                              [](const GravityKey& key) { return !key.value.isZero(0); });
  return plan_item(some, "the scene has gravity", "no gravity");
}

void make_external_force(const TermInputs& inputs, TermList& terms) {
  terms.add(std::make_unique<FamilyTerm>("external_force", TermGroup::load,
                                         weight_family({inputs.executor}, inputs.scene)));
}

}  // namespace bb
