#include "core/contact/executor/policy_kernels.hpp"

#include "core/barrier/launches.hpp"
#include "core/math/error.hpp"

namespace bb::exec {

void require_kernel(const StiffnessPolicy& policy, const std::string& where) {
  if (policy.uniform() || (policy.launches() && policy.launches()->rows)) return;
  throw ConfigError(where, std::string(policy.name()), host_policy_words);
}

void KernelKappa::operator()(std::size_t, const std::uint8_t* missing, bool at_d_hat) const {
  policy.launches()->rows(executor, policy,
                          {rows.view(), missing, policy.needs_hessian(), time, at_d_hat, mass, elastic});
}

}  // namespace bb::exec
