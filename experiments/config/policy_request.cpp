#include "experiments/config/policy_request.hpp"

#include "experiments/config/limit_policies.hpp"

namespace bb {
namespace {

/// The setting that is the stiffness; empty where the policy makes its own, and for a name that is not known.
template <class Entry>
std::string matched(const Registry<Entry>& registry, const PolicyConfig& policy) {
  const Entry* entry = registry.find(policy.name);
  return entry ? entry->matched : "";
}

}  // namespace

bool needs_kappa(const PolicyConfig& policy) { return !matched(stiffness_policies(), policy).empty(); }
bool needs_k_s(const PolicyConfig& policy) { return !matched(limit_policies(), policy).empty(); }

std::optional<double> given_kappa(const PolicyConfig& policy) {
  return optional_number(policy.parameters, matched(stiffness_policies(), policy));
}
std::optional<double> given_k_s(const PolicyConfig& policy) {
  return optional_number(policy.parameters, matched(limit_policies(), policy));
}

StiffnessPolicyConfig policy_request(const PolicyConfig& policy, double kappa, double scale) {
  StiffnessPolicyConfig out{policy.name, policy.parameters, policy.scale * scale};
  if (needs_kappa(policy)) out.parameters[matched(stiffness_policies(), policy)] = kappa;
  return out;
}

}  // namespace bb
