// What conjugate gradients decide from a few numbers, for every loop that runs them: that of the host
// (conjugate_gradients.cpp) and the kernels of an executor (core/linear/executor/pcg_kernels.hpp).
#pragma once

#include <cmath>

#include "core/math/host_device.hpp"

namespace bb {

/// What a run of the recurrence ended with. `converged` still has to face the true residual.
enum class CgEnd : int {
  running,
  converged,
  cap,
  curvature,                  // p^T A p is not positive, or not finite
  preconditioner_indefinite,  // r^T M^-1 r <= 0
  non_finite,
  zero,               // nothing to solve: r is 0 at the start
  no_preconditioner,  // M could not be made
};

/// Between two iterations.
struct CgState {
  double rz;  // r^T M^-1 r
  double rr;  // r^T r
  int iteration;
  CgEnd end;
  BB_HD bool running() const { return end == CgEnd::running; }
};

/// |b|, and what |r| has to come to.
struct CgGoal {
  double b_norm, target;
};
BB_HD inline CgGoal cg_goal(double bb, double tolerance) {
  const double b_norm = std::sqrt(bb);
  return {b_norm, tolerance * b_norm};
}

/// Neither infinite nor NaN.
BB_HD inline bool is_finite(double x) { return x - x == 0; }

/// Whether a step is made along p, of which p^T A p is the curvature. Where not, judge_curvature says why.
BB_HD inline bool gives_step(double curvature) { return curvature > 0 && is_finite(curvature); }

/// After a step: x and r are those of the next iteration. A residual that is not finite is no iteration.
BB_HD inline CgState cg_take_residual(CgState now, double rr, double target) {
  now.rr = rr;
  if (!is_finite(rr)) {
    now.end = CgEnd::non_finite;
    return now;
  }
  ++now.iteration;
  if (std::sqrt(rr) <= target) now.end = CgEnd::converged;
  return now;
}

/// Whether the next iteration begins, with z = M^-1 r.
BB_HD inline CgState cg_go_on(CgState now, double rz, int max_iterations) {
  now.rz = rz;
  if (!now.running()) return now;
  if (!is_finite(rz)) {
    now.end = CgEnd::non_finite;
  } else if (rz <= 0) {
    now.end = CgEnd::preconditioner_indefinite;
  } else if (now.iteration >= max_iterations) {
    now.end = CgEnd::cap;
  }
  return now;
}

/// Of a run that begins with r and z = M^-1 r; iterations of earlier runs count.
BB_HD inline CgState cg_begin(double rz, double rr, int iteration, int max_iterations,
                              bool has_preconditioner) {
  CgState out{rz, rr, iteration, CgEnd::running};
  // NOLINTNEXTLINE(bugprone-branch-clone): what is tested first decides
  if (!is_finite(rr)) {
    out.end = CgEnd::non_finite;
  } else if (rr == 0) {
    out.end = CgEnd::zero;
  } else if (!has_preconditioner) {
    out.end = CgEnd::no_preconditioner;
  }
  return cg_go_on(out, rz, max_iterations);
}

}  // namespace bb
