#include "core/model/integrators/registry.hpp"

namespace bb {

#define ENTRY(name, doc) IntegratorEntry integrator_##name();
#include "core/model/integrators/registry.inc"
#undef ENTRY

Registry<IntegratorEntry>& integrators() {
#define ENTRY(name, doc) named(integrator_##name(), #name, doc),
  static Registry<IntegratorEntry> all({
#include "core/model/integrators/registry.inc"
  });
#undef ENTRY
  return all;
}

std::unique_ptr<Integrator> make_integrator(const std::string& name, const ParameterMap& parameters) {
  const IntegratorEntry& entry = integrators().require(name, "/integrator/name");
  return entry.make(own_parameters(entry.parameters, parameters, "/integrator"));
}

}  // namespace bb
