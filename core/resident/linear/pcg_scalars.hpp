// What conjugate gradients keep in the executor's memory beside vectors: numbers that decide how an iteration goes on.
#pragma once

#include "core/resident/linear/resident_matrix.hpp"

namespace bb::resident {

/// What a run of the recurrence ended with. `converged` still has to face the true residual.
enum class PcgEnd : int {
  running,
  converged,
  cap,
  curvature,                  // p^T A p is not positive, or not finite
  preconditioner_indefinite,  // r^T M^-1 r <= 0
  non_finite,
  zero,        // nothing to solve: r is 0 at the start
  bad_factor,  // a diagonal block or a cluster without a factor: FactorFaults
};

struct PcgState {
  double rz;  // r^T M^-1 r
  double rr;  // r^T r
  int iteration, end;
  BB_HD bool running() const { return end == static_cast<int>(PcgEnd::running); }
};

/// Iterations of a graph. Even, so that state[0] is the present one between graphs.
constexpr int graph_iterations = 16;

/// No kernel reads what it writes itself: iteration k reads state[k % 2], and its last kernel writes the other one.
struct PcgScalars {
  // from the host, before a solve
  double tolerance;  // on |r| / |b|
  int max_iterations;
  // BeginRun
  double b_norm, target;  // |b|, and what |r| has to come to
  // UpdateX..., read by StepDirection
  double curvature;  // p^T A p of the last iteration
  double alpha[graph_iterations], beta[graph_iterations];
  PcgState state[2];
  // FinishSum
  double sum;
};

/// Lowest numbers of vertices or clusters without a factor; no_fault: none.
struct FactorFaults {
  Key non_finite, indefinite, singular;
};
constexpr Key no_fault = ~Key{0};

/// Neither infinite nor NaN.
BB_HD inline bool is_finite(double x) { return x - x == 0; }

}  // namespace bb::resident
