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

/// kappa_e (J) of an element of 2 m^2 and 1 kg at half of its width, without H.
inline double kappa_of_element(const StiffnessPolicy& policy) {
  return policy.element_kappa({3, 0, 1, 2}, 0.5, 1, {});
}

}  // namespace bb::test
