// Bending hinges of the whole scene.
#include <fmt/format.h>

#include "core/energy/hinge_batch.hpp"
#include "core/terms/batch_term.hpp"
#include "core/terms/registry.hpp"

namespace bb {

PlanItem needs_hinges(const TermNeeds& needs) {
  const std::size_t n = needs.scene.hinges.hinges.size();
  return plan_item(n > 0, fmt::format("{} hinges", n), "no bending");
}

void make_hinges(const TermInputs& inputs, TermList& terms) {
  const HingePart& part = inputs.scene.hinges;
  terms.add(std::make_unique<BatchTerm>(
      "hinges",
      std::make_unique<HingeBatch>(part.hinges, part.stiffness, part.rest_angle, inputs.options.precision)));
}

}  // namespace bb
