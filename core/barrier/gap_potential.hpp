// The energy whose force is kappa(d) b'(d), kappa any smooth function of the gap:
//   E(d) = -int_d^{d_hat} kappa(s) b'(s) ds,   E' = kappa b',   E'' = kappa b'' + kappa' b'
// The integral is Gauss-Legendre's with 20 nodes on panels that halve the square of the gap, [d_hat/sqrt 2, d_hat] and so on
// down to d, so that shapes which are joined at half of their argument are smooth in each; where a shape is joined elsewhere
// (Shape::joints) its panel is cut. What is smooth but for a pole or a branch at d = 0 is integrated there to rounding: the error
// falls as 11.6^-40. In the first panel the variable is sqrt(d_hat - s), so that half powers of d_hat - s are smooth too.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/barrier/gap_stiffness.hpp"
#include "core/barrier/shape.hpp"

namespace bb {

class GapPotential {
 public:
  /// Both on any argument, not literal; stiffness must outlive it.
  GapPotential(const BarrierFunction& barrier, const GapStiffness& stiffness);

  /// n rows: E (J), E' (N) and E'' (N/m) in the gap; exactly 0 for d >= d_hat. Requires d > 0, d_hat > 0. Grows its buffers,
  /// allocates nothing else. Not thread-safe. Cost: 40 terms of barrier and stiffness for every halving of the gap,
  /// 20 for every joint.
  void eval(std::size_t n, const double* d, const double* d_hat, const KappaParts* frozen, double* e,
            double* de, double* d2e);

  /// What makes it no energy of a barrier for pairs with such frozen numbers, with the gap where it does: E'' < 0, or an
  /// integral that changes by more than 1e-9 of itself when every panel is halved. Empty: nothing was found at 200 gaps.
  std::string fault(std::span<const KappaParts> frozen, double d_hat);

 private:
  double energy(const KappaParts& frozen, double d, double d_hat, int parts);
  /// The panel that ends at d_hat, cut at joints, and of it the roots from t0 to t1 in equal parts.
  double first_panel(const KappaParts& frozen, double d, double d_hat, int parts);
  double first_part(const KappaParts& frozen, double d, double d_hat, double t0, double t1, int parts);
  /// Another one, cut at joints, and of it the gaps from low to high in equal parts.
  double panel(const KappaParts& frozen, double low, double high, double d_hat, int parts);
  double part(const KappaParts& frozen, double low, double high, double d_hat, int parts);
  /// Terms of the barrier, kappa and its slope at the nodes s_.
  void integrand(const KappaParts& frozen, double d_hat);

  BarrierFunction barrier_;
  const GapStiffness& stiffness_;
  std::vector<double> joints_;  // gaps in units of d_hat, falling
  std::vector<double> s_, width_, b_, db_, d2b_, kappa_, slope_;
};

}  // namespace bb
