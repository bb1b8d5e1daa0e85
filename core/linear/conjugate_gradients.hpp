// Preconditioned conjugate gradients from x = 0, shared by the iterative solvers. Every way to fail has its
// own status; the true residual decides.
#pragma once

#include <cmath>
#include <vector>

#include "core/linear/linear_solver.hpp"
#include "core/linear/parallel.hpp"
#include "core/linear/preconditioner.hpp"
#include "core/linear/symmetric_product.hpp"

namespace bb {

class ConjugateGradients {
 public:
  /// Solves A x = b up to |b - A x| <= tolerance |b|; b is finite and not 0. Fills the iterations, restarts,
  /// residuals and Ritz values of the report.
  LinearStatus solve(const SymmetricProduct& a, const Preconditioner& preconditioner, const VecXd& b,
                     double tolerance, int max_iterations, VecXd& x, LinearReport& report);
  /// The last direction p; after matrix_indefinite p^T A p is negative.
  const VecXd& direction() const { return p_; }
  /// Deterministic for any number of threads.
  double norm(const VecXd& v) { return std::sqrt(dot_(v, v)); }

 private:
  /// What one run of the recurrence ended with; `converged` still has to face the true residual.
  enum class End { converged, cap, truncated, matrix_indefinite, preconditioner_indefinite, non_finite };
  End run(VecXd& x, double target, LinearReport& report);
  End judge_curvature(double curvature) const;
  LinearStatus iterate(const VecXd& b, VecXd& x, double target, LinearReport& report);
  double true_residual(const VecXd& b, const VecXd& x);
  void add_ritz(LinearReport& report) const;

  const SymmetricProduct* a_ = nullptr;
  const Preconditioner* preconditioner_ = nullptr;
  int max_iterations_ = 0;
  ChunkedDot dot_;
  VecXd r_, z_, p_, ap_;
  std::vector<double> alpha_, beta_;
};

}  // namespace bb
