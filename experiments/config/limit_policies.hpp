// The stiffness policies of the strain limit.
#pragma once

#include <string>
#include <vector>

#include "core/parameters/parameter.hpp"
#include "core/parameters/registry.hpp"

namespace bb {

struct LimitPolicyEntry {
  std::string name, doc;
  std::vector<Parameter> parameters;
  std::string matched;  // as StiffnessPolicyEntry::matched
};
const Registry<LimitPolicyEntry>& limit_policies();

}  // namespace bb
