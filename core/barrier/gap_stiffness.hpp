// kappa of a pair as any function of its gap: what a policy with a potential has where KappaParts cannot say it.
#pragma once

#include <cstddef>

#include "core/barrier/stiffness_policy.hpp"

namespace bb {

class GapStiffness {
 public:
  virtual ~GapStiffness() = default;
  /// kappa (N/m) and d kappa/dd (N/m^2) of one pair at n gaps d in (0, d_hat] (m). frozen: what StiffnessPolicy::fill_parts
  /// gave for it, with a meaning of the policy's own. Smooth in d. Cost: O(n), allocates nothing.
  virtual void eval(const KappaParts& frozen, double d_hat, std::size_t n, const double* d, double* kappa,
                    double* slope) const = 0;
};

}  // namespace bb
