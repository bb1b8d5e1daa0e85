// What matching has to know of a config's policies, and the request from which the registry of stiffness
// policies makes one.
#pragma once

#include <optional>

#include "barriers/stiffness/registry.hpp"
#include "experiments/config/run_config.hpp"

namespace bb {

/// True when the stiffness is a number that the config or the matching rule has to supply: of a policy of the
/// contacts, and of one of the strain limit.
bool needs_kappa(const PolicyConfig& policy);
bool needs_k_s(const PolicyConfig& policy);
/// That number, N/m, where the config gives it.
std::optional<double> given_kappa(const PolicyConfig& policy);
std::optional<double> given_k_s(const PolicyConfig& policy);

/// @param kappa  N/m, read by a policy that needs it   @param scale  s of the matching rule
StiffnessPolicyConfig policy_request(const PolicyConfig& policy, double kappa, double scale = 1);

}  // namespace bb
