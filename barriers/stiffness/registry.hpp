// The stiffness policies this program knows: the lines of registry.inc, then what plugins added.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/barrier/stiffness_policy.hpp"

namespace bb {

/// What makes a policy. A policy reads its own fields and ignores the others.
struct StiffnessPolicyConfig {
  std::string name = "fixed";
  double kappa = 0;                          // fixed: N/m, > 0
  MassTerm mass_term = MassTerm::paper;      // elasticity_inclusive
  bool elastic_term = true;                  // elasticity_inclusive
  Refresh refresh = Refresh::per_iteration;  // elasticity_inclusive and plugins
  double multiplier = 1;                     // s of the matching rule: every kappa is multiplied by it
  /// ipc_adaptive: numbers instead of the policy's own rules, as Li et al. 2020 have (docs/design.md).
  struct IpcOverrides {
    std::optional<double> kappa_min, kappa_max;  // N/m, instead of k and 100 k
    std::optional<double> doubling_gap;          // m, instead of 10 park distances
  } ipc;
};

struct StiffnessPolicyEntry {
  std::string name, doc;
  std::function<std::unique_ptr<StiffnessPolicy>(const StiffnessPolicyConfig&)> make;
};

/// All policies, built-ins first, in the order of registry.inc. Host only.
const std::vector<StiffnessPolicyEntry>& stiffness_policies();

/// Adds a policy of a plugin. Not thread-safe: before the first run only.
/// Errors: ConfigError at `where` when the name is taken.
void register_stiffness_policy(StiffnessPolicyEntry entry, std::string_view where = "stiffness_policy");

/// A policy for one run.
/// Errors: ConfigError for an unknown name (with the names allowed and the nearest one), a multiplier or
/// fixed kappa that is not a finite number > 0, overrides that are not > 0 or out of order.
std::unique_ptr<StiffnessPolicy> make_policy(const StiffnessPolicyConfig& config);

std::string_view to_string(MassTerm mass_term);
std::string_view to_string(Refresh refresh);
/// Errors: ConfigError at `where` with the names allowed.
MassTerm require_mass_term(std::string_view name, std::string_view where = "mass_term");
Refresh require_refresh(std::string_view name, std::string_view where = "refresh");

}  // namespace bb
