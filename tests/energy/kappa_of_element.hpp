// What a policy gives one limited triangle.
#pragma once

#include "core/energy/families/limit_family.hpp"
#include "core/exec/host_executor.hpp"

namespace bb::test {

/// kappa_e (J) of a triangle of 2 m^2 and 1 kg at half of its width of 1, without H.
inline double kappa_of_element(const StiffnessPolicy& policy) {
  StrainLimitPart part;
  part.triangles = {{0, 1, 2}};
  part.onset = {0.1}, part.width = {1}, part.mass = {1};
  Positions rest = Positions::Zero(3, 3);
  rest(0, 1) = rest(1, 2) = 2;
  const std::vector<double> gap{0.5}, vertex_mass(3, 1), no_elastic(81, 0);
  exec::HostExecutor executor;
  const auto limit = limited_triangles({executor}, part, rest, false);
  return limit->kappa_at(gap, policy, {{}, rest.data(), vertex_mass.data(), {{}, no_elastic.data()}})[0];
}

}  // namespace bb::test
