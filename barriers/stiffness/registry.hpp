// The stiffness policies this program knows: the lines of registry.inc, then what plugins added.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/barrier/stiffness_policy.hpp"
#include "core/parameters/parameter.hpp"
#include "core/parameters/registry.hpp"

namespace bb {

/// What makes a policy.
struct StiffnessPolicyConfig {
  std::string name = "fixed";
  ParameterMap parameters;  // of the policy of that name; what is left out has its default
  double multiplier = 1;    // s of the matching rule: every kappa is multiplied by it
};

struct StiffnessPolicyEntry {
  std::string name, doc;
  std::vector<Parameter> parameters;  // its own, with defaults
  /// The parameter that is the stiffness, N/m, which the matching rule supplies when it is left out; empty:
  /// the policy makes its own kappa.
  std::string matched;
  std::function<std::unique_ptr<StiffnessPolicy>(const StiffnessPolicyConfig& complete)> make;
};

/// All policies, built-ins first, in the order of registry.inc. Host only.
Registry<StiffnessPolicyEntry>& stiffness_policies();

/// A policy for one run. Errors: ConfigError for an unknown name (with the names allowed and the nearest
/// one), for what own_parameters refuses, for a multiplier that is not a finite number > 0, and for what the
/// policy itself refuses.
std::unique_ptr<StiffnessPolicy> make_policy(const StiffnessPolicyConfig& config);

/// When kappa is computed anew, for policies that can.
Parameter refresh_parameter();

/// The smallest gap at which kappa is asked, in units of the barrier's width: a pair that ended a step parked
/// near contact would have m/d^2 of that gap in the next one.
Parameter gap_floor_parameter();

/// What becomes of kappa'(d), for policies whose kappa depends on the gap.
Parameter derivative_parameter();
/// derivative `included` goes with refresh per_step, a mass term that depends on the gap, and no gap_floor.
/// Errors: ConfigError below `where`. parameters: with mass_term, refresh, gap_floor and derivative.
void check_derivative(const ParameterMap& parameters, const std::string& where);

std::string_view to_string(MassTerm mass_term);
std::string_view to_string(Refresh refresh);
std::string_view to_string(KappaDerivative derivative);
/// Errors: ConfigError at `where` with the names allowed.
MassTerm require_mass_term(std::string_view name, std::string_view where = "mass_term");
Refresh require_refresh(std::string_view name, std::string_view where = "refresh");
KappaDerivative require_derivative(std::string_view name, std::string_view where = "derivative");

}  // namespace bb
