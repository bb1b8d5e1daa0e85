// The registry of preconditioners.
#include "core/linear/preconditioner.hpp"

namespace bb {

#define ENTRY(name, doc) PreconditionerEntry preconditioner_##name();
#include "core/linear/preconditioners.inc"
#undef ENTRY

const Registry<PreconditionerEntry>& preconditioners() {
#define ENTRY(name, doc) named(preconditioner_##name(), #name, doc),
  static const Registry<PreconditionerEntry> all({
#include "core/linear/preconditioners.inc"
  });
#undef ENTRY
  return all;
}

std::unique_ptr<Preconditioner> make_preconditioner(const std::string& name, const ParameterMap& parameters) {
  const PreconditionerEntry& entry = preconditioners().require(name, "/linear_solver/preconditioner");
  return entry.make(own_parameters(entry.parameters, parameters, "/linear_solver"));
}

}  // namespace bb
