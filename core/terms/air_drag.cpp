// Drag of the air on triangles: 1/(2 h) u^T C u with u = x - x_n - h wind.
#include "core/energy/families/families.hpp"
#include "core/terms/family_term.hpp"
#include "core/terms/registry.hpp"

namespace bb {

PlanItem needs_air_drag(const TermNeeds& needs) {
  const Air& air = needs.scene.air;
  const bool some = (air.normal > 0 || air.tangential > 0) && !needs.scene.surface_triangles.empty();
  return plan_item(some, "the air has drag", "no drag of the air, or no triangle in it");
}

void make_air_drag(const TermInputs& inputs, TermList& terms) {
  terms.add(std::make_unique<FamilyTerm>("air_drag", TermGroup::load,
                                         air_drag_family({inputs.executor}, inputs.scene)));
}

}  // namespace bb
