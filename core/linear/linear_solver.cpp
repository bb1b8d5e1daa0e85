// What all linear solvers do alike, and the words of their statuses.
#include "core/linear/linear_solver.hpp"

#include "core/linear/preconditioner.hpp"

namespace bb {

std::string_view to_string(LinearStatus status) {
  switch (status) {
    case LinearStatus::ok:
      return "ok";
    case LinearStatus::matrix_indefinite:
      return "matrix_indefinite";
    case LinearStatus::preconditioner_indefinite:
      return "preconditioner_indefinite";
    case LinearStatus::tolerance_below_rounding:
      return "tolerance_below_rounding";
    case LinearStatus::non_finite:
      return "non_finite";
    case LinearStatus::iteration_cap:
      return "iteration_cap";
    case LinearStatus::factor_too_large:
      return "factor_too_large";
  }
  return "";
}

LinearReport LinearSolver::solve(const ReducedSystem& system, const VecXd& b, VecXd& x, RightSide of) {
  of_ = of;
  if (b.size() != system.lower.rows()) {
    throw ConfigError("right-hand side", std::to_string(b.size()) + " entries", "one a row of the matrix");
  }
  x = VecXd::Zero(b.size());
  try {
    return solve_checked(system, b, x);
  } catch (const FactorTooLarge& error) {
    x.setZero();
    LinearReport report;
    report.status = LinearStatus::factor_too_large;
    report.detail = error.what();
    report.residual_true = report.residual_recurrence = 1;
    return report;
  }
}

Definiteness LinearSolver::examine(const ReducedSystem& a, const NearMatrix& near) {
  constexpr int most_iterations = 10000;
  SymmetricProduct rows;
  return examine_preconditioned(a, near, *make_preconditioner("block_jacobi"), most_iterations, rows);
}

}  // namespace bb
