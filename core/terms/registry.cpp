#include "core/terms/registry.hpp"

namespace bb {

#define ENTRY(name, doc, convex)           \
  PlanItem needs_##name(const TermNeeds&); \
  void make_##name(const TermInputs&, TermList&);
#include "core/terms/registry.inc"
#undef ENTRY

std::span<const TermEntry> term_entries() {
  static constexpr TermEntry all[] = {
#define ENTRY(name, doc, convex) {#name, doc, convex, needs_##name, make_##name},
#include "core/terms/registry.inc"
#undef ENTRY
  };
  return all;
}

}  // namespace bb
