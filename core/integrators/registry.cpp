#include "core/integrators/registry.hpp"

#include "core/math/error.hpp"

namespace bb {

#define ENTRY(name, doc) std::unique_ptr<Integrator> make_##name();
#include "core/integrators/registry.inc"
#undef ENTRY

namespace {
std::vector<IntegratorEntry>& entries() {
  static std::vector<IntegratorEntry> all = {
#define ENTRY(name, doc) {#name, doc, make_##name},
#include "core/integrators/registry.inc"
#undef ENTRY
  };
  return all;
}

const IntegratorEntry* find(const std::string& name) {
  for (const IntegratorEntry& entry : entries()) {
    if (entry.name == name) return &entry;
  }
  return nullptr;
}
}  // namespace

const std::vector<IntegratorEntry>& integrators() { return entries(); }

void register_integrator(IntegratorEntry entry) {
  if (find(entry.name)) {
    throw ConfigError("plugin integrator", '"' + entry.name + '"', "a name that is not registered yet");
  }
  entries().push_back(std::move(entry));
}

std::unique_ptr<Integrator> make_integrator(const std::string& name) {
  if (const IntegratorEntry* entry = find(name)) return entry->make();
  std::string known;
  for (const IntegratorEntry& entry : entries()) known += (known.empty() ? "" : ", ") + entry.name;
  throw ConfigError("/integrator/name", '"' + name + '"', "one of " + known);
}

}  // namespace bb
