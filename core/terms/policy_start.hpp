// When a policy with memory starts, and from which numbers: at the first iterate that has contacts, from B with kappa = 1
// and the gradient of everything else (docs/theory/barriers.md, Stiffness policies).
#pragma once

#include "core/barrier/shape.hpp"
#include "core/barrier/stiffness_policy.hpp"
#include "core/model/scene/scene.hpp"

namespace bb {

/// The sums over a state that only its owner can make. grad_b and grad_e as in StiffnessGlobals.
struct StartSums {
  double grad_b_dot_grad_e = 0, grad_b_sq = 0;  // m N, m^2
  double mean_contact_mass = 0;  // kg, of the free vertices of the rows, each counted once a row
};

class PolicyStart {
 public:
  /// Whether the policy has to be started at an iterate with so many rows.
  bool due(const StiffnessPolicy& policy, std::size_t n_rows) const {
    return !started_ && policy.needs_globals() && n_rows > 0;
  }
  /// Errors: ConfigError of the policy.
  void start(StiffnessPolicy& policy, const Scene& scene, const BarrierFunction& barrier,
             const StartSums& sums, const StiffnessTime& time);
  bool started() const { return started_; }
  /// By another system, by a checkpoint, or not at all.
  void set_started(bool started) { started_ = started; }

 private:
  bool started_ = false;
};

}  // namespace bb
