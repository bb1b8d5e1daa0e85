// Stitches: k/2 (|x_b - x_a| - l0)^2.
#include <fmt/format.h>

#include "core/energy/spring_batch.hpp"
#include "core/terms/batch_term.hpp"
#include "core/terms/registry.hpp"

namespace bb {

PlanItem needs_stitch(const TermNeeds& needs) {
  const std::size_t n = needs.scene.stitches.pairs.size();
  return plan_item(n > 0, fmt::format("{} stitches", n), "nothing is stitched");
}

void make_stitch(const TermInputs& inputs, TermList& terms) {
  const Stitches& stitches = inputs.scene.stitches;
  terms.add(std::make_unique<BatchTerm>(
      "stitch", std::make_unique<SpringBatch>(stitches.pairs, stitches.rest_length, stitches.stiffness,
                                              inputs.options.precision)));
}

}  // namespace bb
