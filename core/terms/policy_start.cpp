#include "core/terms/policy_start.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace bb {
namespace {

double max_free_mass(const Scene& scene) {
  std::vector<std::uint8_t> given(scene.mass.size(), 0);
  for (const Pin& pin : scene.pins) given[static_cast<std::size_t>(pin.vertex)] = 1;
  double largest = 0;
  for (std::size_t i = 0; i < scene.mass.size(); ++i) {
    if (!given[i]) largest = std::max(largest, scene.mass[i]);
  }
  return largest;
}

}  // namespace

void PolicyStart::start(StiffnessPolicy& policy, const Scene& scene, const BarrierFunction& barrier,
                        const StartSums& sums, const StiffnessTime& time) {
  StiffnessGlobals globals;
  globals.grad_b_dot_grad_e = sums.grad_b_dot_grad_e;
  globals.grad_b_sq = sums.grad_b_sq;
  globals.mean_contact_mass = sums.mean_contact_mass;
  globals.max_free_mass = max_free_mass(scene);
  globals.d_hat = *std::min_element(scene.d_hat.begin(), scene.d_hat.end());
  globals.d2b_half = barrier.eval(globals.d_hat / 2, globals.d_hat).d2b;
  globals.time = time;
  policy.start(globals);
  started_ = true;
}

}  // namespace bb
