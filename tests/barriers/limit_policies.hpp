// Stiffness policies of a strain limit, from numbers.
#pragma once

#include <memory>

#include "barriers/stiffness/elasticity_inclusive.hpp"
#include "barriers/stiffness/fixed.hpp"
#include "barriers/stiffness/item_policy.hpp"

namespace bb::test {

/// kappa_e = k_s (N/m) x rest area.
inline std::unique_ptr<StiffnessPolicy> fixed_limit(double k_s) {
  return std::make_unique<ItemPolicy<Fixed>>("fixed", Fixed{k_s}, 1.0);
}
inline std::unique_ptr<StiffnessPolicy> elastic_limit(const ElasticityInclusive& values = {},
                                                      double multiplier = 1) {
  return std::make_unique<ItemPolicy<ElasticityInclusive>>("elasticity_inclusive", values, multiplier);
}

}  // namespace bb::test
