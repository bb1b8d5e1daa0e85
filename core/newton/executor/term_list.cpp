#include "core/newton/executor/term_list.hpp"

#include <string>

#include "core/math/error.hpp"
#include "core/newton/executor/lagged_term.hpp"
#include "core/terms/executor/element_terms.hpp"
#include "core/terms/executor/family_term.hpp"

namespace bb::exec {
namespace {

/// One a line of registry.inc, in its order; null where the line states host_only.
#define BB_MAKE_kernels(name) &make_##name##_on_executor
#define BB_MAKE_host_only(name) nullptr
#define ENTRY(name, doc, convex, where) BB_MAKE_##where(name),
#define BB_PART_kernels(name) &make_part_on_executor<parts::name::part>
#define BB_PART_host_only(name) nullptr
#define PART(name, doc, convex, where, ...) BB_PART_##where(name),
#define BB_LAGGED_kernels(name) \
  [](const ExecutorInputs& inputs, ExecutorTerms& terms) { add_lagged(#name, name##_family, inputs, terms); }
#define BB_LAGGED_host_only(name) nullptr
#define LAGGED(name, doc, convex, where) BB_LAGGED_##where(name),
constexpr MakeOnExecutor* makers[] = {
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

ExecutorTerms make_terms_on_executor(const Plan& plan, const ExecutorInputs& inputs) {
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

}  // namespace bb::exec
