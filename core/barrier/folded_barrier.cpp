#include "core/barrier/folded_barrier.hpp"

#include <stdexcept>

namespace bb {

BarrierFunction potential_of(const BarrierFunction& barrier) {
  if (!has_potential(barrier)) throw std::logic_error("no potential: " + barrier.shape.name);
  BarrierFunction out = barrier;
  out.shape.batch_double = barrier.shape.potential_double;
  out.shape.batch_float = barrier.shape.potential_float;
  out.shape.potential_double = nullptr;
  out.shape.potential_float = nullptr;
  out.shape.infinite_at_zero = true;
  return out;
}

void FoldedBarrier::eval(std::size_t n, const double* d, const double* d_hat, const KappaParts* parts,
                         double* e, double* de, double* d2e) {
  for (std::vector<double>* column : {&psi_, &dpsi_, &d2psi_}) column->resize(n);
  barrier_.eval(n, d, d_hat, e, de, d2e);
  potential_.eval(n, d, d_hat, psi_.data(), dpsi_.data(), d2psi_.data());
  for (std::size_t i = 0; i < n; ++i) {
    const double fixed = parts[i].fixed, at_d_hat = parts[i].per_gap_sq / (d_hat[i] * d_hat[i]);
    e[i] = fixed * e[i] + at_d_hat * psi_[i];
    de[i] = fixed * de[i] + at_d_hat * dpsi_[i];
    d2e[i] = fixed * d2e[i] + at_d_hat * d2psi_[i];
  }
}

}  // namespace bb
