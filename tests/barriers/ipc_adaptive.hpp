// The policy ipc_adaptive on a state whose balance is known.
#pragma once

#include <memory>

#include "barriers/stiffness/registry.hpp"

namespace bb::test {

inline std::unique_ptr<StiffnessPolicy> ipc_adaptive(const ParameterMap& given = {}, double multiplier = 1) {
  PolicyConfig config;
  config.name = "ipc_adaptive";
  config.parameters = given;
  config.scale = multiplier;
  return make_policy(config);
}

/// Sums of a state whose forces balance at kappa = `balance` (N/m), with k = 2e-3/(0.5 1e-4 8) = 5 N/m: the policy's own
/// bounds of kappa are 5 and 500 N/m.
inline StiffnessGlobals balanced_at(double balance) {
  StiffnessGlobals out;
  out.grad_b_sq = 4e-6;
  out.grad_b_dot_grad_e = -balance * out.grad_b_sq;
  out.mean_contact_mass = 2e-3;
  out.d2b_half = 8;
  out.time = {0.01, 0.5}, out.d_hat = 1e-3;
  return out;
}

}  // namespace bb::test
