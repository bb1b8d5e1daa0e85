// Preconditioned conjugate gradients from x = 0. Every way to fail has its own status; the
// true residual decides.
#include <chrono>
#include <cmath>
#include <limits>
#include <string>

#include "core/linear/cg_ritz.hpp"
#include "core/linear/linear_solver.hpp"
#include "core/linear/parallel.hpp"
#include "core/linear/preconditioner.hpp"
#include "core/linear/symmetric_product.hpp"
#include "core/math/error.hpp"

namespace bb {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

class Pcg final : public LinearSolver {
 public:
  explicit Pcg(const ParameterMap& parameters)
      : tol_rel_(number(parameters, "tol_rel")),
        max_iterations_(integer(parameters, "max_iterations")),
        preconditioner_(make_preconditioner(text(parameters, "preconditioner"), parameters)) {}
  std::string_view name() const override { return "pcg"; }
  LinearReport solve(const ReducedSystem& system, const VecXd& b, VecXd& x) override;

 private:
  LinearStatus iterate(const VecXd& b, VecXd& x, double b_norm, LinearReport& report);
  /// What one run of the recurrence ended with; `converged` still has to face the true residual.
  enum class End { converged, cap, truncated, matrix_indefinite, preconditioner_indefinite, non_finite };
  End run(VecXd& x, double target, LinearReport& report);
  double true_residual(const VecXd& b, const VecXd& x);
  void add_ritz(LinearReport& report) const;

  double tol_rel_;
  int max_iterations_;
  std::unique_ptr<Preconditioner> preconditioner_;
  SymmetricProduct product_;
  ChunkedDot dot_;
  VecXd r_, z_, p_, ap_;
  std::vector<double> alpha_, beta_;
};

double Pcg::true_residual(const VecXd& b, const VecXd& x) {
  product_.multiply(x, ap_);
  ap_ = b - ap_;
  return std::sqrt(dot_(ap_, ap_));
}

void Pcg::add_ritz(LinearReport& report) const {
  const RitzExtremes run = cg_ritz_extremes(alpha_, beta_);
  if (run.max == 0) return;
  report.ritz_min = report.ritz_max == 0 ? run.min : std::min(report.ritz_min, run.min);
  report.ritz_max = std::max(report.ritz_max, run.max);
}

Pcg::End Pcg::run(VecXd& x, double target, LinearReport& report) {
  alpha_.clear();
  beta_.clear();
  preconditioner_->apply(r_, z_);
  p_ = z_;
  double rz = dot_(r_, z_);
  for (;; ++report.iterations) {
    if (!std::isfinite(rz)) return End::non_finite;
    if (rz <= 0) return End::preconditioner_indefinite;
    if (report.iterations >= max_iterations_) return End::cap;
    product_.multiply(p_, ap_);
    const double curvature = dot_(p_, ap_);
    if (!std::isfinite(curvature)) return End::non_finite;
    if (curvature <= 0) {
      // 256 eps sum |terms|: a negative sign inside this bound may be rounding, beyond it cannot.
      const double scale = product_.absolute_quadratic(p_);
      const double rounding = 256 * std::numeric_limits<double>::epsilon() * scale;
      return curvature < -rounding || scale == 0 ? End::matrix_indefinite : End::truncated;
    }
    const double alpha = rz / curvature;
    x += alpha * p_;
    r_ -= alpha * ap_;
    alpha_.push_back(alpha);
    const double r_norm = std::sqrt(dot_(r_, r_));
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

LinearStatus Pcg::iterate(const VecXd& b, VecXd& x, double b_norm, LinearReport& report) {
  const double target = tol_rel_ * b_norm;
  double last_true = std::numeric_limits<double>::infinity();
  r_ = b;
  for (;; ++report.restarts) {
    const End end = run(x, target, report);
    add_ritz(report);
    if (end == End::matrix_indefinite) return LinearStatus::matrix_indefinite;
    if (end == End::preconditioner_indefinite) return LinearStatus::preconditioner_indefinite;
    const double residual = true_residual(b, x);
    if (end == End::non_finite || !std::isfinite(residual)) return LinearStatus::non_finite;
    if (residual <= target) return LinearStatus::ok;
    if (end == End::cap) return LinearStatus::iteration_cap;
    // The recurrence claims more than the solution holds. Start again from the true residual
    // while that helps.
    if (end == End::truncated || residual > 0.5 * last_true) return LinearStatus::tolerance_below_rounding;
    last_true = residual;
    r_ = ap_;
  }
}

LinearReport Pcg::solve(const ReducedSystem& system, const VecXd& b, VecXd& x) {
  if (b.size() != system.lower.rows()) {
    throw ConfigError("right-hand side", std::to_string(b.size()) + " entries", "one a row of the matrix");
  }
  LinearReport report;
  report.iterative = true;
  x = VecXd::Zero(b.size());
  const Clock::time_point start = Clock::now();
  product_.update(system);
  const double b_norm = std::sqrt(dot_(b, b));
  if (!std::isfinite(b_norm) || !product_.all_finite()) {
    report.status = LinearStatus::non_finite;
  } else if (b_norm > 0) {
    report.status = preconditioner_->setup(system, product_);
    report.preconditioner_shifts = preconditioner_->shifts();
    report.preconditioner_shift = preconditioner_->shift();
  }
  report.factor_s = seconds_since(start);
  if (b_norm == 0) return report;
  report.residual_true = report.residual_recurrence = 1;
  if (report.status != LinearStatus::ok) return report;

  report.residual_recurrence = b_norm;
  report.status = iterate(b, x, b_norm, report);
  report.residual_recurrence /= b_norm;
  report.residual_true = true_residual(b, x) / b_norm;
  report.solve_s = seconds_since(start) - report.factor_s;
  return report;
}

}  // namespace

LinearSolverEntry linear_solver_pcg() {
  LinearSolverEntry entry;
  entry.iterative = true;
  entry.parameters = {
      {"preconditioner", name_in([] { return preconditioners().names(); }), "block_jacobi",
       "a registered preconditioner"},
      {"tol_rel", open_high(open_low(number_in(0, 1, "1"))), 1e-8, "|r| <= tol_rel |b|"},
      {"max_iterations", count(1, 1000000000), 10000, "cap on iterations of a solve"},
  };
  entry.make = [](const ParameterMap& complete) -> std::unique_ptr<LinearSolver> {
    return std::make_unique<Pcg>(complete);
  };
  return entry;
}

}  // namespace bb
