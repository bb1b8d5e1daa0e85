// How far an inexact solve of Newton's method has to go: far enough that the method converges as fast as its
// matrices let it, no further.
#pragma once

#include <vector>

#include "core/base/parameters/parameter.hpp"

namespace bb {

/// What the right-hand side of a Newton direction is: the residual alone, or with the forces of what prescribed vertices have to
/// move yet.
enum class RightSide { residual, with_motion };

/// Tolerances on |r|/|b| from the norms of successive right-hand sides of one step, which are the residuals of
/// Newton's method.
class Forcing {
 public:
  /// complete: with the rows of parameters().
  explicit Forcing(const ParameterMap& complete);
  /// Those that solvers with a forcing have: forcing and tol_rel.
  static std::vector<Parameter> parameters();

  /// What was known of the residuals no longer holds.
  void begin_step() { last_norm_ = 0; }
  /// For a right-hand side of this norm, > 0. The norm of the call before again: another attempt at the same
  /// iterate, so the same tolerance. eisenstat_walker: choice 2 of Eisenstat, Walker 1996, eta = 0.9 (|b| over
  /// the |b| before)^2, at least 0.9 eta_before^2 where that is above 0.1 (their safeguard), at most 0.1 and at
  /// least tol_rel; 0.1 for the first of a step.
  /// with_motion: 1e-3, and the next residual is as the first of a step. Its norm is that of the stiffest contacts of what is
  /// moved, so with a tenth of it left their neighbours do not follow, and gaps close instead (belt of the catalogue, 80 steps:
  /// 505 iterations with a direct solver, 590 with 1e-3, 1932 with 1e-2, and with 0.1 step 35 does not end).
  double tolerance(double b_norm, RightSide of = RightSide::residual);

 private:
  bool adaptive_;
  double tol_rel_, last_norm_ = 0, eta_ = 0;
};

}  // namespace bb
