#include "core/terms/policy_start.hpp"

#include <algorithm>

namespace bb {

void PolicyStart::start(StiffnessPolicy& policy, const Scene& scene, const BarrierFunction& barrier,
                        const StartSums& sums, const StiffnessTime& time) {
  StiffnessGlobals globals;
  globals.grad_b_dot_grad_e = sums.grad_b_dot_grad_e;
  globals.grad_b_sq = sums.grad_b_sq;
  globals.mean_contact_mass = sums.mean_contact_mass;
  globals.d_hat = *std::min_element(scene.d_hat.begin(), scene.d_hat.end());
  globals.d2b_half = barrier.eval(globals.d_hat / 2, globals.d_hat).d2b;
  globals.time = time;
  policy.start(globals);
  started_ = true;
}

}  // namespace bb
