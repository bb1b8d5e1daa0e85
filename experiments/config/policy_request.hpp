// What matching has to know of a config's policies.
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

/// Whether the limit acts on solids, so that its policy gives tetrahedra a stiffness.
bool limits_solids(const StrainLimitConfig& limit);

/// The policy with that number, N/m, where it needs one, and with its own factor times `scale`, s of the matching rule.
PolicyConfig policy_request(PolicyConfig policy, PolicyUse use, double stiffness, double scale = 1);

}  // namespace bb
