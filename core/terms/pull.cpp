// Soft pins: k/2 |x - p(t)|^2.
#include <fmt/format.h>

#include "core/energy/families/families.hpp"
#include "core/terms/family_term.hpp"
#include "core/terms/registry.hpp"

namespace bb {

PlanItem needs_pull(const TermNeeds& needs) {
  std::size_t n = 0;
  for (const Pull& pull : needs.scene.pulls) n += pull.vertices.size();
  return plan_item(n > 0, fmt::format("{} pulled vertices", n), "no pin pulls");
}

void make_pull(const TermInputs& inputs, TermList& terms) {
  terms.add(
      std::make_unique<FamilyTerm>("pull", TermGroup::load, pull_family({inputs.executor}, inputs.scene)));
}

}  // namespace bb
