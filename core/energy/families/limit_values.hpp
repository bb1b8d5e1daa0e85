// What the kernels of a strain limit are given from outside, and what they report of a state.
#pragma once

#include "core/barrier/stiffness_sums.hpp"
#include "core/exec/sums/sum_kernels.hpp"
#include "core/linear/executor/executor_matrix.hpp"

namespace bb {

/// H as a policy reads it: the matrix of an executor, or its sub-matrix of each element, [(3 w)^2 n] column-major, where that is
/// given. N/m.
struct ElasticMatrix {
  exec::MatrixPart part{};
  const double* gathered = nullptr;
};

/// From what a policy makes kappa_e. Pointers are memory of the executor.
struct KappaSources {
  StiffnessTime time;
  const double* x_n;          // [3 n_vertices] m, start of the step
  const double* vertex_mass;  // [n_vertices] kg
  ElasticMatrix elastic;      // read where the policy needs it
};

/// What is reported of a state: complements of keys (sum_kernels.hpp) of the largest singular value, of the largest force of
/// an active element over its rest area or volume, N/m or Pa, and of the smallest pseudo-gap in units of the width.
struct LimitNumbers {
  exec::Key stretch, load, gap;
  BB_HD static LimitNumbers zero() { return {0, 0, 0}; }
  friend BB_HD LimitNumbers operator+(const LimitNumbers& a, const LimitNumbers& b) {
    LimitNumbers out = a;
    exec::raise_key(out.stretch, b.stretch), exec::raise_key(out.load, b.load);
    exec::raise_key(out.gap, b.gap);
    return out;
  }
};

}  // namespace bb
