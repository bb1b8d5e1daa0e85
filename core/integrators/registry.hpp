// The integrators by name. Built-ins come from registry.inc, plugins are added at run time.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/integrators/integrator.hpp"

namespace bb {

struct IntegratorEntry {
  std::string name, doc;
  std::function<std::unique_ptr<Integrator>()> make;
};

/// All integrators, built-ins first.
const std::vector<IntegratorEntry>& integrators();
/// Adds a plugin's integrator. Throws ConfigError when the name is taken.
void register_integrator(IntegratorEntry entry);
/// Throws ConfigError for an unknown name, listing the known ones.
std::unique_ptr<Integrator> make_integrator(const std::string& name);

}  // namespace bb
