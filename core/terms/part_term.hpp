// The elastic terms: the elements of a part (core/model/bodies/part.hpp), one term a family.
#pragma once

#include "core/model/bodies/part.hpp"
#include "core/terms/host_term.hpp"
#include "core/terms/term_inputs.hpp"

namespace bb {

/// That of its line in core/model/scene/parts/registry.inc.
std::string_view name_of(const Part& part);
PlanItem needs_part(const Part& part, const TermNeeds& needs);
void make_part(const Part& part, const TermInputs& inputs, TermList& terms);

/// The same as the functions that a TermEntry has.
template <const Part& (*part)()>
PlanItem needs_part(const TermNeeds& needs) {
  return needs_part(part(), needs);
}
template <const Part& (*part)()>
void make_part(const TermInputs& inputs, TermList& terms) {
  make_part(part(), inputs, terms);
}

}  // namespace bb
