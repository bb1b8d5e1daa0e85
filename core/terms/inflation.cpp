// A pressure from within closed surfaces: -p V.
#include <fmt/format.h>

#include "core/energy/families/families.hpp"
#include "core/terms/family_term.hpp"
#include "core/terms/registry.hpp"

namespace bb {

PlanItem needs_inflation(const TermNeeds& needs) {
  const std::size_t n = needs.scene.inflation.triangles.size();
  return plan_item(n > 0, fmt::format("{} triangles under pressure", n), "no body is under pressure");
}

void make_inflation(const TermInputs& inputs, TermList& terms) {
  const FamilyPlace place{inputs.executor, inputs.options.precision};
  terms.add(
      std::make_unique<FamilyTerm>("inflation", TermGroup::load, inflation_family(place, inputs.scene)));
}

}  // namespace bb
