// Checks all names first, so that a clash leaves the registries as they were.
#include "barriers/plugins.hpp"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "barriers/shapes/registry.hpp"
#include "barriers/stiffness/registry.hpp"
#include "core/base/parameters/registry.hpp"
#include "core/model/integrators/registry.hpp"

namespace bb {
namespace {

/// Appends a violation for every added name that is known, or given twice by the plugin itself.
template <class Known, class Added>
void check_names(const std::string& file, const char* kind, const Registry<Known>& known,
                 const std::vector<Added>& added, std::vector<Violation>& wrong) {
  std::vector<std::string> taken = known.names();
  for (const Added& entry : added) {
    for (const std::string& name : taken) {
      if (name != entry.name) continue;
      wrong.push_back({file, fmt::format("{} \"{}\"", kind, name),
                       fmt::format("a name not yet taken by another {}", kind)});
      break;
    }
    taken.push_back(entry.name);
  }
}

}  // namespace

Plugin register_plugin(const std::string& file) {
  Plugin plugin = load_plugin(file);
  std::vector<Violation> wrong;
  check_names(file, "shape", all_shapes(), plugin.shapes, wrong);
  check_names(file, "stiffness policy", stiffness_policies(), plugin.policies, wrong);
  check_names(file, "integrator", integrators(), plugin.integrators, wrong);
  if (!wrong.empty()) throw ConfigError(std::move(wrong));

  for (const Shape& shape : plugin.shapes) all_shapes().add(shape, file);
  for (const PluginPolicy& policy : plugin.policies) {
    const auto make = [policy](const PolicyConfig& config) {
      return policy.make(require_refresh(text(config.parameters, "refresh")), config.scale);
    };
    stiffness_policies().add({policy.name, policy.doc, {refresh_parameter()}, "", make}, file);
  }
  for (const IntegratorEntry& integrator : plugin.integrators) integrators().add(integrator, file);
  return plugin;
}

}  // namespace bb
