#include "core/linear/condition_dense.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "core/linear/extreme_pairs.hpp"
#include "core/linear/lanczos.hpp"

namespace bb {
namespace {

constexpr int kMaxPolish = 400;
constexpr double kSettled = 1e-12;  // relative change of a Rayleigh quotient that ends the polishing

/// v^T B v / v^T v in long double: right to the square of the error of v.
double rayleigh(const Eigen::MatrixXd& b, const VecXd& v) {
  long double numerator = 0, denominator = 0;
  for (Eigen::Index j = 0; j < b.cols(); ++j) {
    long double product = 0;
    for (Eigen::Index i = 0; i < b.rows(); ++i) product += static_cast<long double>(b(i, j)) * v[i];
    numerator += product * v[j];
    denominator += static_cast<long double>(v[j]) * v[j];
  }
  return static_cast<double>(numerator / denominator);
}

/// The dense eigenvalue at the small end is right to some n eps |B| only. Inverse iteration from below it, until
/// the Rayleigh quotient settles: the shift is far from eigenvalues that are as small as that error, so a few
/// steps would leave a mixture of them.
double polish(const Eigen::MatrixXd& b, double lambda, double lambda_max) {
  const double offset = 64 * std::numeric_limits<double>::epsilon() * lambda_max;
  const Eigen::PartialPivLU<Eigen::MatrixXd> factor(b - (lambda - offset) *
                                                            Eigen::MatrixXd::Identity(b.rows(), b.cols()));
  VecXd v = seeded_vector(b.rows(), 1);
  double last = lambda, now = lambda;
  for (int step = 0; step < kMaxPolish; ++step) {
    v = factor.solve(v).normalized().eval();
    if (!v.allFinite()) return lambda;
    now = rayleigh(b, v);
    if (step > 3 && std::abs(now - last) <= kSettled * std::abs(now)) break;
    last = now;
  }
  return now;
}

}  // namespace

ConditionEstimate estimate_dense(const ReducedSystem& system, const BlockScaling& scaling) {
  ConditionEstimate e;
  e.method = "dense";
  e.lambda_min = e.lambda_max = e.cond = std::numeric_limits<double>::quiet_NaN();
  e.status = ConditionStatus::not_converged;
  const Eigen::Index n = system.lower.rows();
  if (n == 0 || n > 3000) return e;

  Eigen::MatrixXd b = Eigen::MatrixXd(system.lower).selfadjointView<Eigen::Lower>();
  VecXd column;
  for (int side = 0; side < 2; ++side) {  // L^-1 from the left, twice round a transposition
    for (Eigen::Index j = 0; j < n; ++j) {
      column = b.col(j);
      scaling.solve_lower(column);
      b.col(j) = column;
    }
    b.transposeInPlace();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(b, Eigen::EigenvaluesOnly);
  if (eigen.info() != Eigen::Success) return e;
  e.lambda_min = eigen.eigenvalues()[0];
  e.lambda_max = eigen.eigenvalues()[n - 1];
  // Above 1e9 the rounding of the dense solver, n eps |B|, would reach 1e-3 of lambda_min at n = 3000.
  if (std::abs(e.lambda_min) < 1e-9 * e.lambda_max) e.lambda_min = polish(b, e.lambda_min, e.lambda_max);
  classify(e, true);
  return e;
}

}  // namespace bb
