// Springs of the whole scene.
#include <fmt/format.h>

#include "core/energy/spring_batch.hpp"
#include "core/terms/batch_term.hpp"
#include "core/terms/registry.hpp"

namespace bb {

PlanItem needs_springs(const TermNeeds& needs) {
  const std::size_t n = needs.scene.springs.edges.size();
  return plan_item(n > 0, fmt::format("{} springs", n), "no spring");
}

void make_springs(const TermInputs& inputs, TermList& terms) {
  const SpringPart& part = inputs.scene.springs;
  terms.add(std::make_unique<BatchTerm>(
      "springs", std::make_unique<SpringBatch>(part.edges, inputs.scene.rest, part.stiffness,
                                               inputs.options.precision)));
}

}  // namespace bb
