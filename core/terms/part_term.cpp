#include "core/terms/part_term.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "core/terms/family_term.hpp"

namespace bb {

std::string_view name_of(const Part& part) {
  for (const PartEntry& entry : part_entries()) {
    if (&entry.part == &part) return entry.name;
  }
  throw std::logic_error("a part that is not in core/model/scene/parts/registry.inc");
}

PlanItem needs_part(const Part& part, const TermNeeds& needs) {
  const std::size_t n = part.size(needs.scene);
  return plan_item(n > 0, fmt::format("{} {}", n, part.elements()), std::string(part.no_elements()));
}

void make_part(const Part& part, const TermInputs& inputs, TermList& terms) {
  std::vector<std::unique_ptr<ElementFamily>> families;
  part.add_families(inputs.scene, {inputs.executor, inputs.options.precision}, families);
  for (auto& family : families)
    terms.add(std::make_unique<FamilyTerm>(name_of(part), TermGroup::elastic, std::move(family)));
}

}  // namespace bb
