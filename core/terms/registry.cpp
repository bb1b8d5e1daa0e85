#include "core/terms/registry.hpp"

#include "core/terms/lagged_contacts.hpp"
#include "core/terms/part_term.hpp"

namespace bb {

#define ENTRY(name, ...)                   \
  PlanItem needs_##name(const TermNeeds&); \
  void make_##name(const TermInputs&, TermList&);
#define PART(...)
#define LAGGED(name, ...) PlanItem needs_##name(const TermNeeds&);
#include "core/terms/registry.inc"
#undef ENTRY
#undef PART
#undef LAGGED

std::span<const TermEntry> term_entries() {
  static constexpr TermEntry all[] = {
#define ENTRY(name, doc, convex, ...) {#name, doc, convex, needs_##name, make_##name},
#define PART(name, doc, convex, ...) \
  {#name, doc, convex, needs_part<parts::name::part>, make_part<parts::name::part>},
#define LAGGED(name, doc, convex, ...) \
  {#name, doc, convex, needs_##name,   \
   [](const TermInputs& inputs, TermList& terms) { add_lagged(#name, name##_family, inputs, terms); }},
#include "core/terms/registry.inc"
#undef ENTRY
#undef PART
#undef LAGGED
  };
  return all;
}

}  // namespace bb
