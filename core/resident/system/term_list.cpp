#include "core/resident/system/term_list.hpp"

#include <string>

#include "core/math/error.hpp"
#include "core/resident/elements/element_terms.hpp"
#include "core/resident/elements/family_term.hpp"
#include "core/resident/system/lagged_term.hpp"

namespace bb::resident {
namespace {

/// One a line of registry.inc, in its order; null where the line says host_only.
#define BB_MAKE_kernels(name) &make_resident_##name
#define BB_MAKE_host_only(name) nullptr
#define ENTRY(name, doc, convex, where) BB_MAKE_##where(name),
#define BB_PART_kernels(name) &make_resident_part<parts::name::part>
#define BB_PART_host_only(name) nullptr
#define PART(name, doc, convex, where, ...) BB_PART_##where(name),
#define BB_LAGGED_kernels(name) \
  [](const ResidentInputs& inputs, ExecutorTerms& terms) { add_lagged(#name, name##_family, inputs, terms); }
#define BB_LAGGED_host_only(name) nullptr
#define LAGGED(name, doc, convex, where) BB_LAGGED_##where(name),
constexpr MakeResident* makers[] = {
#include "core/terms/registry.inc"
};
#undef ENTRY
#undef PART
#undef LAGGED
#undef BB_MAKE_kernels
#undef BB_MAKE_host_only
#undef BB_PART_kernels
#undef BB_PART_host_only
#undef BB_LAGGED_kernels
#undef BB_LAGGED_host_only

}  // namespace

ExecutorTerms make_resident_terms(const Plan& plan, const ResidentInputs& inputs) {
  ExecutorTerms terms;
  for (std::size_t i = 0; i < plan.terms.size(); ++i) {
    if (!plan.terms[i].needed) continue;
    if (!makers[i]) {  // it would be left out of E
      throw ConfigError("/device", std::string(term_entries()[i].name) + ", a term without kernels",
                        "a scene without it, or device cpu");
    }
    makers[i](inputs, terms);
  }
  return terms;
}

}  // namespace bb::resident
