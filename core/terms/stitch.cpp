// Stitches: k/2 (|x_b - x_a| - l0)^2.
#include <fmt/format.h>

#include "core/energy/families/families.hpp"
#include "core/terms/family_term.hpp"
#include "core/terms/registry.hpp"

namespace bb {

PlanItem needs_stitch(const TermNeeds& needs) {
  const std::size_t n = needs.scene.stitches.pairs.size();
  return plan_item(n > 0, fmt::format("{} stitches", n), "nothing is stitched");
}

void make_stitch(const TermInputs& inputs, TermList& terms) {
  const FamilyPlace place{inputs.executor, inputs.options.precision};
  terms.add(std::make_unique<FamilyTerm>("stitch", TermGroup::elastic,
                                         stitch_family(place, inputs.scene.stitches)));
}

}  // namespace bb
