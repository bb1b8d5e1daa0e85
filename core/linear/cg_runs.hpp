// Conjugate gradients as runs of the recurrence: a run claims a residual, the true one decides, and where it is larger
// another run begins from it. The runs themselves are those of the host or of an executor.
#pragma once

#include <vector>

#include "core/linear/cg_decisions.hpp"
#include "core/linear/linear_solver.hpp"

namespace bb {

/// How a run ended.
struct CgRun {
  CgState state;
  CgGoal goal;
  double curvature;  // p^T A p of the last iteration
};

class CgRuns {
 public:
  virtual ~CgRuns() = default;

 protected:
  /// Until the recurrence ends; alpha_ and beta_ are those of this run.
  virtual CgRun run() = 0;
  /// sum |p_i| |A_ij| |p_j| of the last direction: the scale of the rounding error of p^T A p.
  virtual double curvature_magnitude() = 0;
  /// |b - A x|.
  virtual double true_residual() = 0;
  /// r = b - A x, as true_residual() left it.
  virtual void restart() = 0;

  /// Fills iterations, restarts, residuals and Ritz values of the report; those of an earlier solve add up.
  LinearStatus solve_by_runs(LinearReport& report);

  std::vector<double> alpha_, beta_;  // step lengths, and ratios of successive r^T M^-1 r

 private:
  LinearStatus judge_curvature(double curvature);
  void add_ritz(LinearReport& report) const;
};

}  // namespace bb
