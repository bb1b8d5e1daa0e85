// The direct solver of the registry: a CholmodFactor with its report.
#include <chrono>
#include <string>

#include "core/linear/block_starts.hpp"
#include "core/linear/cholmod_factor.hpp"

namespace bb {
namespace {

class Cholmod final : public LinearSolver {
 public:
  std::string_view name() const override { return "cholmod"; }

  LinearReport solve_checked(const ReducedSystem& system, const VecXd& b, VecXd& x) override {
    LinearReport report;
    if (b.size() == 0) return report;
    report.status = factor_.factorize(system);
    report.analyzed = factor_.analyzed_last();
    report.factorized = report.status == LinearStatus::ok;
    if (report.factorized) {
      report.factor_nnz = factor_.factor_nonzeros();
      report.factor_flop = factor_.factor_flops();
    }
    report.analyze_s = factor_.analyze_s();
    report.factor_s = factor_.factor_s();
    report.residual_true = 1;  // of x = 0
    if (report.status == LinearStatus::matrix_indefinite) {
      report.detail = "no positive pivot at " + vertex_text(system, factor_.failed_dof());
    }
    if (report.status != LinearStatus::ok) return report;
    if (!b.allFinite()) {
      report.status = LinearStatus::non_finite;
      return report;
    }
    const auto start = std::chrono::steady_clock::now();
    factor_.solve(b, x);
    report.solve_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (!x.allFinite()) report.status = LinearStatus::non_finite;
    residual_ = b - system.lower.selfadjointView<Eigen::Lower>() * x;
    const double b_norm = b.norm();
    report.residual_true = b_norm > 0 ? residual_.norm() / b_norm : 0;
    return report;
  }

 private:
  CholmodFactor factor_;
  VecXd residual_;
};

}  // namespace

LinearSolverEntry linear_solver_cholmod() {
  LinearSolverEntry entry;
  entry.make = [](const ParameterMap&) -> std::unique_ptr<LinearSolver> {
    return std::make_unique<Cholmod>();
  };
  return entry;
}

}  // namespace bb
