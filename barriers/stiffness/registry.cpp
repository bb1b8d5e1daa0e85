// The lists of stiffness policies, filled once from registry.inc.
#include "barriers/stiffness/registry.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

namespace bb {

#define ENTRY(name, doc) std::optional<StiffnessPolicyEntry> policy_##name(PolicyUse use, const char* about);
#include "barriers/stiffness/registry.inc"
#undef ENTRY

namespace {

std::vector<StiffnessPolicyEntry> builtin_policies(PolicyUse use) {
  std::vector<StiffnessPolicyEntry> all;
  const auto add = [&all](std::optional<StiffnessPolicyEntry> entry) {
    if (entry) all.push_back(std::move(*entry));
  };
#define ENTRY(name, doc) add(policy_##name(use, doc));
#include "barriers/stiffness/registry.inc"
#undef ENTRY
  return all;
}

}  // namespace

Registry<StiffnessPolicyEntry>& stiffness_policies() {
  static Registry<StiffnessPolicyEntry> all(builtin_policies(PolicyUse::contact));
  return all;
}

const Registry<StiffnessPolicyEntry>& limit_policies() {
  static const Registry<StiffnessPolicyEntry> all(builtin_policies(PolicyUse::limit));
  return all;
}

const Registry<StiffnessPolicyEntry>& policies_of(PolicyUse use) {
  return use == PolicyUse::limit ? limit_policies() : stiffness_policies();
}

std::unique_ptr<StiffnessPolicy> make_policy(const PolicyConfig& config, PolicyUse use) {
  if (!(config.scale > 0) || !std::isfinite(config.scale)) {
    throw ConfigError("stiffness_policy/scale", fmt::format("{}", config.scale), "a number > 0");
  }
  const StiffnessPolicyEntry& entry = policies_of(use).require(config.name, "stiffness_policy/name");
  PolicyConfig complete = config;
  complete.parameters = own_parameters(entry.parameters, config.parameters, "stiffness_policy");
  return entry.make(complete);
}

Parameter refresh_parameter() {
  return {"refresh", word({"per_iteration", "per_step"}), "per_iteration", "when kappa is computed anew"};
}
std::string_view to_string(Refresh refresh) {
  return refresh == Refresh::per_iteration ? "per_iteration" : "per_step";
}
Refresh require_refresh(std::string_view name, std::string_view where) {
  for (const Refresh refresh : {Refresh::per_iteration, Refresh::per_step}) {
    if (to_string(refresh) == name) return refresh;
  }
  throw unknown_name(where, name, {"per_iteration", "per_step"});
}

}  // namespace bb
