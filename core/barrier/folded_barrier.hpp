// A barrier with its stiffness folded in: energy and true derivatives where kappa depends on the gap.
#pragma once

#include <vector>

#include "core/barrier/shape.hpp"
#include "core/barrier/stiffness_policy.hpp"

namespace bb {

/// Whether kappa/d^2 times the slope of this barrier has a potential in closed form.
inline bool has_potential(const BarrierFunction& barrier) {
  return barrier.argument == Argument::gap && !barrier.literal && barrier.shape.potential_double != nullptr;
}

/// d_hat^2 psi as a barrier of its own, infinite at contact: kappa_1 times it has the force of the barrier with
/// kappa(d) = kappa_1 (d_hat/d)^2. Errors: std::logic_error unless has_potential(barrier).
BarrierFunction potential_of(const BarrierFunction& barrier);

/// E(d) = fixed b(d) + per_gap_sq psi(d) of rows whose kappa(d) is fixed + per_gap_sq/d^2:
///   E' = kappa(d) b'(d),   E'' = kappa(d) b''(d) + kappa'(d) b'(d)
class FoldedBarrier {
 public:
  /// Errors: std::logic_error unless has_potential(barrier).
  explicit FoldedBarrier(const BarrierFunction& barrier)
      : barrier_(barrier), potential_(potential_of(barrier)) {}

  /// n rows: energies (J), E' (N) and E'' (N/m) in the gap; exactly 0 for d >= d_hat. Requires d > 0, d_hat > 0.
  /// Grows its buffers, allocates nothing else. Not thread-safe.
  void eval(std::size_t n, const double* d, const double* d_hat, const KappaParts* parts, double* e,
            double* de, double* d2e);

 private:
  BarrierFunction barrier_, potential_;
  std::vector<double> psi_, dpsi_, d2psi_;
};

}  // namespace bb
