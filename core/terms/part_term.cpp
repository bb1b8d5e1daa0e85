#include "core/terms/part_term.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "core/terms/batch_term.hpp"

namespace bb {
namespace {

std::string_view name_of(const Part& part) {
  for (const PartEntry& entry : part_entries()) {
    if (&entry.part == &part) return entry.name;
  }
  throw std::logic_error("a part that is not in core/scene/parts/registry.inc");
}

}  // namespace

PlanItem needs_part(const Part& part, const TermNeeds& needs) {
  const std::size_t n = part.size(needs.scene);
  return plan_item(n > 0, fmt::format("{} {}", n, part.elements()), std::string(part.no_elements()));
}

void make_part(const Part& part, const TermInputs& inputs, TermList& terms) {
  std::vector<std::unique_ptr<EnergyBatch>> batches;
  part.add_batches(inputs.scene, inputs.options.precision, batches);
  for (std::unique_ptr<EnergyBatch>& batch : batches) {
    terms.add(std::make_unique<BatchTerm>(name_of(part), std::move(batch)));
  }
}

}  // namespace bb
