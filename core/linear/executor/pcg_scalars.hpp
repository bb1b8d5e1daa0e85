// What conjugate gradients keep in the executor's memory beside vectors: numbers that decide how an iteration goes on.
#pragma once

#include "core/linear/cg_decisions.hpp"
#include "core/linear/executor/executor_matrix.hpp"

namespace bb::exec {

/// Iterations of a graph. Even, so that state[0] is the present one between graphs.
constexpr int graph_iterations = 16;

/// No kernel reads what it writes itself: iteration k reads state[k % 2], and its last kernel writes the other one.
struct PcgScalars {
  // from the host, before a solve
  double tolerance;  // on |r| / |b|
  int max_iterations;
  // BeginRun
  CgGoal goal;
  // UpdateX..., read by StepDirection
  double curvature;  // p^T A p of the last iteration
  double alpha[graph_iterations], beta[graph_iterations];
  CgState state[2];
  // FinishSum
  double sum;
};

/// Lowest numbers of vertices or clusters without a factor; no_fault: none.
struct FactorFaults {
  Key non_finite, indefinite, singular;
};
constexpr Key no_fault = ~Key{0};

}  // namespace bb::exec
