// From the struct of a policy to its entry in a registry.
#pragma once

#include <memory>
#include <optional>

#include "barriers/stiffness/item_policy.hpp"
#include "barriers/stiffness/policy_parameters.hpp"

namespace bb {

/// Nothing where P does not serve strain limits. doc: of its use for contacts.
template <class P>
std::optional<StiffnessPolicyEntry> policy_entry(const char* name, const char* doc, PolicyUse use) {
  if (use == PolicyUse::limit) {
    if constexpr (ItemPolicy<P>::of_elements) {
      doc = P::limit_doc;
    } else {
      return std::nullopt;
    }
  }
  const PolicyParameters<P> list(use);
  StiffnessPolicyEntry entry{name, doc, list.rows(), list.matched(), nullptr};
  entry.make = [list, name](const PolicyConfig& config) -> std::unique_ptr<StiffnessPolicy> {
    const P values = list.values(config.parameters);
    if constexpr (requires { typename P::Policy; }) {
      return std::make_unique<typename P::Policy>(values, config.scale);
    } else if constexpr (requires { values.times(config.scale); }) {
      return std::make_unique<ItemPolicy<P>>(name, values.times(config.scale), 1.0);
    } else {
      return std::make_unique<ItemPolicy<P>>(name, values, config.scale);
    }
  };
  return entry;
}

}  // namespace bb
