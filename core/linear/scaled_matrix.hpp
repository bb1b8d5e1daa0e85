// B = L^-1 A L^-T and its inverses round Cholesky factors, every use counted in an estimate.
#pragma once

#include <algorithm>
#include <vector>

#include "core/linear/extreme_pairs.hpp"

namespace bb {

/// B and its inverses, counting every use.
class ScaledMatrix {
 public:
  ScaledMatrix(FactoredMatrix& matrix, const BlockScaling& scaling, ConditionEstimate& counts)
      : m_(matrix), s_(scaling), counts_(counts) {}

  void multiply(const VecXd& v, VecXd& out) {
    u_ = v;
    s_.solve_upper(u_);
    m_.product.multiply(u_, out);
    s_.solve_lower(out);
    ++counts_.products;
  }
  void solve(CholmodFactor& factor, const VecXd& v, VecXd& out) {
    u_ = v;
    s_.multiply_lower(u_);
    factor.solve(u_, out);
    s_.multiply_upper(out);
    ++counts_.solves;
  }
  /// Rayleigh quotient of B at v in long double: accurate to 1e-18 |B|, where double would leave 1e-16 |B|.
  /// The residual |B v - lambda v| / |v| becomes counts.residual where it is larger, still absolute.
  double rayleigh(const VecXd& v) {
    u_ = v;
    s_.solve_upper(u_);
    m_.product.multiply_long(u_, au_);
    ++counts_.products;
    long double numerator = 0;
    for (Eigen::Index i = 0; i < u_.size(); ++i) numerator += au_[static_cast<std::size_t>(i)] * u_[i];
    const double lambda = static_cast<double>(numerator / s_.quadratic(u_));
    VecXd bv(u_.size());
    for (Eigen::Index i = 0; i < u_.size(); ++i)
      bv[i] = static_cast<double>(au_[static_cast<std::size_t>(i)]);
    s_.solve_lower(bv);
    counts_.residual = std::max(counts_.residual, (bv - lambda * v).norm() / v.norm());
    return lambda;
  }
  /// Factorises sign * (A - sigma D).
  bool factorize_shifted(double sign, double sigma) {
    m_.shifted_system.lower = m_.system->lower;
    m_.shifted_system.block_start = m_.system->block_start;
    m_.shifted_system.pattern_id = m_.system->pattern_id;
    s_.add_to(m_.shifted_system.lower, sign, -sign * sigma);
    ++counts_.factorizations;
    return m_.shifted.factorize(m_.shifted_system) == LinearStatus::ok;
  }

  FactoredMatrix& matrix() { return m_; }
  Eigen::Index n() const { return m_.product.n(); }

 private:
  FactoredMatrix& m_;
  const BlockScaling& s_;
  ConditionEstimate& counts_;
  VecXd u_;
  std::vector<long double> au_;
};

}  // namespace bb
