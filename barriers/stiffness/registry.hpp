// The stiffness policies this program knows: the lines of registry.inc, then what plugins added.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/barrier/stiffness_policy.hpp"
#include "core/base/parameters/parameter.hpp"
#include "core/base/parameters/registry.hpp"

namespace bb {

/// The stiffness policy that a run requests, of its contacts or of its strain limit.
struct PolicyConfig {
  std::string name = "fixed";
  double scale = 1;         // factor on every kappa of the policy
  ParameterMap parameters;  // of the policy of that name; what is left out has its default
};

/// What a policy gives a stiffness to.
enum class PolicyUse { contact, limit };

struct StiffnessPolicyEntry {
  std::string name, doc;
  std::vector<Parameter> parameters;  // its own, with defaults
  /// The parameter that is the stiffness, N/m, which the matching rule supplies when it is left out; empty:
  /// the policy makes its own kappa.
  std::string matched;
  std::function<std::unique_ptr<StiffnessPolicy>(const PolicyConfig& complete)> make;
};

/// All policies of contacts, built-ins first, in the order of registry.inc. Host only.
Registry<StiffnessPolicyEntry>& stiffness_policies();
/// Those of them that serve strain limits, as such: plugins bring none.
const Registry<StiffnessPolicyEntry>& limit_policies();
/// One of these two.
const Registry<StiffnessPolicyEntry>& policies_of(PolicyUse use);

/// A policy for one run. Errors: ConfigError for an unknown name (with the names allowed and the nearest
/// one), for what own_parameters refuses, for a scale that is not a finite number > 0, and for what the
/// policy itself refuses.
std::unique_ptr<StiffnessPolicy> make_policy(const PolicyConfig& config, PolicyUse use = PolicyUse::contact);

/// When kappa is computed anew, for policies that can.
Parameter refresh_parameter();
std::string_view to_string(Refresh refresh);
/// Errors: ConfigError at `where` with the names allowed.
Refresh require_refresh(std::string_view name, std::string_view where = "refresh");

}  // namespace bb
