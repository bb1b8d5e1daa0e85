// Loads a plugin (core/model/plugin/barrierbench_plugin.h) and wraps what it holds in the pipeline's own
// interfaces. Registering the result is the caller's: barriers/plugins.hpp.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/barrier/shape.hpp"
#include "core/barrier/stiffness_policy.hpp"
#include "core/model/integrators/registry.hpp"

namespace bb {

/// A stiffness policy of a plugin. `multiplier` scales every kappa.
struct PluginPolicy {
  std::string name, doc;
  std::function<std::unique_ptr<StiffnessPolicy>(Refresh refresh, double multiplier)> make;
};

struct Plugin {
  std::string file, name;
  std::vector<Shape> shapes;
  std::vector<PluginPolicy> policies;
  std::vector<IntegratorEntry> integrators;
};

/// Opens the library, in a child process first; it stays open until the process ends. Runs the plugin's
/// code. Errors: ConfigError at the file: no regular file, not a whole or not a loadable library, one that
/// crashes, exits or hangs while it is loaded, no symbol barrierbench_plugin, another abi_version; and all
/// entries at once that have no snake_case name or lack one of their calls, a NULL array, a flag or a
/// smoothness out of range.
Plugin load_plugin(const std::string& file);

/// Another function that a library exports which load_plugin() has opened; null without one.
void* find_symbol(const std::string& file, const char* name);

}  // namespace bb
