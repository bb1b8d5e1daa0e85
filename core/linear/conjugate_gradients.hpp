// Preconditioned conjugate gradients from x = 0 on the host, shared by the iterative solvers. Every way to fail has its
// own status; the true residual decides (cg_runs.hpp).
#pragma once

#include <cmath>

#include "core/linear/cg_runs.hpp"
#include "core/linear/parallel.hpp"
#include "core/linear/preconditioner.hpp"
#include "core/linear/symmetric_product.hpp"

namespace bb {

class ConjugateGradients final : CgRuns {
 public:
  /// Solves A x = b up to |b - A x| <= tolerance |b|. Fills the iterations, restarts, residuals and Ritz values of the
  /// report; max_iterations counts those that are in it already.
  LinearStatus solve(const SymmetricProduct& a, const Preconditioner& preconditioner, const VecXd& b,
                     double tolerance, int max_iterations, VecXd& x, LinearReport& report);
  /// The last direction p; after matrix_indefinite p^T A p is negative.
  const VecXd& direction() const { return p_; }
  /// Deterministic for any number of threads.
  double norm(const VecXd& v) { return std::sqrt(dot_(v, v)); }

 private:
  CgRun run() override;
  CgState iterate(const CgState& now, double alpha);
  double curvature_magnitude() override { return a_->absolute_quadratic(p_); }
  double true_residual() override;
  void restart() override { r_ = ap_; }

  // of the solve
  const SymmetricProduct* a_ = nullptr;
  const Preconditioner* preconditioner_ = nullptr;
  const VecXd* b_ = nullptr;
  VecXd* x_ = nullptr;
  int max_iterations_ = 0, iteration_ = 0;
  CgGoal goal_{};
  double rr_ = 0;  // at the start of a run

  ChunkedDot dot_;
  VecXd r_, z_, p_, ap_;
};

}  // namespace bb
