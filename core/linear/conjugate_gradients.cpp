#include "core/linear/conjugate_gradients.hpp"

#include <cmath>
#include <limits>

#include "core/linear/cg_ritz.hpp"
#include "core/linear/solve_detail.hpp"

namespace bb {

double ConjugateGradients::true_residual(const VecXd& b, const VecXd& x) {
  a_->multiply(x, ap_);
  ap_ = b - ap_;
  return norm(ap_);
}

void ConjugateGradients::add_ritz(LinearReport& report) const {
  const RitzExtremes run = cg_ritz_extremes(alpha_, beta_);
  if (run.max == 0) return;
  report.ritz_min = report.ritz_max == 0 ? run.min : std::min(report.ritz_min, run.min);
  report.ritz_max = std::max(report.ritz_max, run.max);
}

// Of a curvature p^T A p that is not positive.
ConjugateGradients::End ConjugateGradients::judge_curvature(double curvature) const {
  if (!std::isfinite(curvature)) return End::non_finite;
  // 256 eps sum |terms|: a negative sign inside this bound may be rounding, beyond it cannot.
  const double scale = a_->absolute_quadratic(p_);
  const double rounding = 256 * std::numeric_limits<double>::epsilon() * scale;
  return curvature < -rounding || scale == 0 ? End::matrix_indefinite : End::truncated;
}

ConjugateGradients::End ConjugateGradients::run(VecXd& x, double target, LinearReport& report) {
  alpha_.clear();
  beta_.clear();
  preconditioner_->apply(r_, z_);
  p_ = z_;
  double rz = dot_(r_, z_);
  for (;; ++report.iterations) {
    if (!std::isfinite(rz)) return End::non_finite;
    if (rz <= 0) return End::preconditioner_indefinite;
    if (report.iterations >= max_iterations_) return End::cap;
    a_->multiply(p_, ap_);
    const double curvature = dot_(p_, ap_);
    if (!(curvature > 0) || !std::isfinite(curvature)) return judge_curvature(curvature);
    const double alpha = rz / curvature;
    x += alpha * p_;
    r_ -= alpha * ap_;
    alpha_.push_back(alpha);
    const double r_norm = norm(r_);
    report.residual_recurrence = r_norm;
    if (!std::isfinite(r_norm)) return End::non_finite;
    if (r_norm <= target) {
      ++report.iterations;
      return End::converged;
    }
    preconditioner_->apply(r_, z_);
    const double rz_next = dot_(r_, z_);
    beta_.push_back(rz_next / rz);
    p_ = z_ + beta_.back() * p_;
    rz = rz_next;
  }
}

LinearStatus ConjugateGradients::iterate(const VecXd& b, VecXd& x, double target, LinearReport& report) {
  double last_true = std::numeric_limits<double>::infinity();
  r_ = b;
  for (;; ++report.restarts) {
    const End end = run(x, target, report);
    add_ritz(report);
    report.residual_true = true_residual(b, x);
    if (end == End::matrix_indefinite) return LinearStatus::matrix_indefinite;
    if (end == End::preconditioner_indefinite) return LinearStatus::preconditioner_indefinite;
    if (end == End::non_finite || !std::isfinite(report.residual_true)) return LinearStatus::non_finite;
    if (report.residual_true <= target) return LinearStatus::ok;
    if (end == End::cap) return LinearStatus::iteration_cap;
    // The recurrence claims more than the solution holds. Start again from the true residual
    // while that helps.
    if (end == End::truncated || report.residual_true > 0.5 * last_true) {
      return LinearStatus::tolerance_below_rounding;
    }
    last_true = report.residual_true;
    r_ = ap_;
  }
}

LinearStatus ConjugateGradients::solve(const SymmetricProduct& a, const Preconditioner& preconditioner,
                                       const VecXd& b, double tolerance, int max_iterations, VecXd& x,
                                       LinearReport& report) {
  a_ = &a;
  preconditioner_ = &preconditioner;
  max_iterations_ = max_iterations;
  x = VecXd::Zero(b.size());
  const double b_norm = norm(b);
  report.residual_recurrence = b_norm;
  report.tolerance = tolerance;
  report.status = iterate(b, x, tolerance * b_norm, report);
  report.residual_recurrence /= b_norm;
  report.residual_true /= b_norm;
  report.detail = solve_detail(report);
  return report.status;
}

}  // namespace bb
