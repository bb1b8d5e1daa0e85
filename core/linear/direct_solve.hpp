// A solve with a Cholesky factor, and its report: what the direct solvers share.
#pragma once

#include <string>

#include "core/linear/linear_solver.hpp"
#include "core/linear/preconditioner.hpp"
#include "core/linear/stopwatch.hpp"

namespace bb {

/// Factorises A and solves. Factor: factorize, solve, analyzed_last, analyze_s, factor_s, factor_nonzeros and
/// factor_flops as CholmodFactor has them, and failure(system), why the last factorisation is matrix_indefinite.
/// residual: workspace.
template <class Factor>
LinearReport solve_directly(Factor& factor, const ReducedSystem& system, const VecXd& b, VecXd& x,
                            VecXd& residual) {
  LinearReport report;
  if (b.size() == 0) return report;
  report.status = factor.factorize(system);
  report.analyzed = factor.analyzed_last();
  report.factorized = report.status == LinearStatus::ok;
  if (report.factorized) {
    report.factor_nnz = factor.factor_nonzeros();
    report.factor_flop = factor.factor_flops();
  }
  report.analyze_s = factor.analyze_s();
  report.factor_s = factor.factor_s();
  report.residual_true = 1;  // of x = 0
  if (report.status == LinearStatus::matrix_indefinite) report.detail = factor.failure(system);
  if (report.status != LinearStatus::ok) return report;
  if (!b.allFinite()) {
    report.status = LinearStatus::non_finite;
    return report;
  }
  const Stopwatch stopwatch;
  factor.solve(b, x);
  report.solve_s = stopwatch.seconds();
  if (!x.allFinite()) report.status = LinearStatus::non_finite;
  residual = b - system.lower.selfadjointView<Eigen::Lower>() * x;
  const double b_norm = b.norm();
  report.residual_true = b_norm > 0 ? residual.norm() / b_norm : 0;
  return report;
}

/// As LinearSolver::examine, with a factor of A; where there is none, conjugate gradients with one of `near` find a
/// direction of negative curvature, or that only rounding was in the way.
template <class Factor>
Definiteness examine_directly(Factor& factor, const ReducedSystem& a, const NearMatrix& near) {
  class Applied final : public Preconditioner {
   public:
    explicit Applied(Factor& of) : of_(of) {}
    LinearStatus setup(const ReducedSystem& system, const SymmetricProduct&) override {
      return of_.factorize(system);
    }
    void apply(const VecXd& r, VecXd& z) const override { of_.solve(r, z); }

   private:
    Factor& of_;
  };
  constexpr int most_iterations = 300;
  Definiteness out;
  const LinearStatus status = factor.factorize(a);
  if (status == LinearStatus::matrix_indefinite) {
    Applied applied(factor);
    SymmetricProduct rows;
    out = examine_preconditioned(a, near, applied, most_iterations, rows);
    ++out.factorizations;
  } else if (status == LinearStatus::ok) {
    out.verdict = Definiteness::Verdict::positive;
    out.by_factor = true;
  }
  ++out.factorizations;
  return out;
}

}  // namespace bb
