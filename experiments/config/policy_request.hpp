// From a config's contact policy to what the registry of stiffness policies makes.
#pragma once

#include "barriers/stiffness/registry.hpp"
#include "experiments/config/run_config.hpp"

namespace bb {

/// True when the stiffness is a number that the config or the matching rule has to supply.
bool needs_kappa(const PolicyConfig& policy);

/// @param kappa  N/m, read by a policy that needs it   @param scale  s of the matching rule
StiffnessPolicyConfig policy_request(const PolicyConfig& policy, double kappa, double scale = 1);

}  // namespace bb
