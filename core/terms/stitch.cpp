// Stitches: k/2 (|x_b - x_a| - l0)^2.
#include "core/terms/stitch.hpp"

#include <fmt/format.h>

#include "core/energy/families/families.hpp"
#include "core/terms/family_term.hpp"
#include "core/terms/registry.hpp"

namespace bb {

std::unique_ptr<ElementFamily> stitch_family(const FamilyPlace& place, const Stitches& stitches) {
  return spring_family(place, {"stitched vertices", "stitch stiffness", "stitch rest lengths"}, stitches.pairs,
                       stitches.stiffness, stitches.rest_length);
}

PlanItem needs_stitch(const TermNeeds& needs) {
  const std::size_t n = needs.scene.stitches.pairs.size();
  return plan_item(n > 0, fmt::format("{} stitches", n), "nothing is stitched");
}

void make_stitch(const TermInputs& inputs, TermList& terms) {
  const FamilyPlace place{inputs.executor, inputs.options.precision};
  terms.add(std::make_unique<FamilyTerm>("stitch", stitch_family(place, inputs.scene.stitches)));
}

}  // namespace bb
