#include "experiments/config/policy_request.hpp"

namespace bb {

bool needs_kappa(const PolicyConfig& policy) { return policy.name == "fixed"; }

StiffnessPolicyConfig policy_request(const PolicyConfig& policy, double kappa, double scale) {
  StiffnessPolicyConfig out;
  out.name = policy.name;
  out.kappa = kappa;
  out.mass_term = policy.mass_term;
  out.elastic_term = policy.elastic_term;
  out.refresh = policy.refresh;
  out.multiplier = policy.scale * scale;
  out.ipc = {policy.kappa_min, policy.kappa_max, policy.doubling_gap};
  return out;
}

}  // namespace bb
