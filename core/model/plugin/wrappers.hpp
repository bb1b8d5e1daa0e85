// A plugin's policy and integrator behind the pipeline's interfaces. Internal to this module.
#pragma once

#include <memory>

#include "core/barrier/stiffness_policy.hpp"
#include "core/model/integrators/integrator.hpp"
#include "core/model/plugin/barrierbench_plugin.h"

namespace bb {

/// The referenced table must outlive the result, as everything a plugin returns does.
std::unique_ptr<StiffnessPolicy> wrap_policy(const bb_plugin_policy& policy, Refresh refresh,
                                             double multiplier);

/// predict throws ConfigError when the plugin answers with a c that is not a finite number > 0.
std::unique_ptr<Integrator> wrap_integrator(const bb_plugin_integrator& integrator);

}  // namespace bb
