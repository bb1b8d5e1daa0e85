// Membranes: one term a model in use, in the order in which bodies bring them.
#include <fmt/format.h>

#include "core/energy/membrane_batch.hpp"
#include "core/terms/batch_term.hpp"
#include "core/terms/registry.hpp"

namespace bb {

PlanItem needs_membrane(const TermNeeds& needs) {
  const std::size_t n = needs.scene.membrane_triangles().size();
  return plan_item(n > 0, fmt::format("{} triangles", n), "no membrane element");
}

void make_membrane(const TermInputs& inputs, TermList& terms) {
  const Scene& scene = inputs.scene;
  for (const MembranePart& part : scene.membranes) {
    if (part.triangles.empty()) continue;
    terms.add(std::make_unique<BatchTerm>(
        "membrane", std::make_unique<MembraneBatch>(part.model, part.triangles, scene.rest, part.lame_mu,
                                                    part.lame_lambda, scene.planar, part.warp,
                                                    inputs.options.precision)));
  }
}

}  // namespace bb
