#include "experiments/config/policy_request.hpp"

namespace bb {
namespace {

/// The setting that is the stiffness; empty where the policy makes its own, and for a name that is not known.
std::string matched(const PolicyConfig& policy, PolicyUse use) {
  const StiffnessPolicyEntry* entry = policies_of(use).find(policy.name);
  return entry ? entry->matched : "";
}

}  // namespace

bool needs_kappa(const PolicyConfig& policy) { return !matched(policy, PolicyUse::contact).empty(); }
bool needs_k_s(const PolicyConfig& policy) { return !matched(policy, PolicyUse::limit).empty(); }

std::optional<double> given_kappa(const PolicyConfig& policy) {
  return optional_number(policy.parameters, matched(policy, PolicyUse::contact));
}
std::optional<double> given_k_s(const PolicyConfig& policy) {
  return optional_number(policy.parameters, matched(policy, PolicyUse::limit));
}

bool limits_solids(const StrainLimitConfig& limit) { return limit.enabled && limit.solids.value_or(false); }

PolicyConfig policy_request(PolicyConfig policy, PolicyUse use, double stiffness, double scale) {
  policy.scale *= scale;
  const std::string setting = matched(policy, use);
  if (!setting.empty()) policy.parameters[setting] = stiffness;
  return policy;
}

}  // namespace bb
