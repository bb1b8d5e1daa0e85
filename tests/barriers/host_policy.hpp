// A stiffness policy of the host alone, as one of a plugin is: no kernel knows it.
#pragma once

#include "core/barrier/stiffness_policy.hpp"

namespace bb::test {

struct HostPolicy : StiffnessPolicy {
  std::string_view name() const override { return "host_only"; }
  Refresh refresh() const override { return Refresh::per_step; }
  void fill(const StiffnessBatch&, double*) const override {}
};

}  // namespace bb::test
