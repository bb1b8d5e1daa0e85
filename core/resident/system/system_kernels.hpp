// What a Newton iteration does with whole columns beside the operations of vectors.hpp.
#pragma once

#include "core/resident/sums/sum_kernels.hpp"

namespace bb::resident {

/// b = -(g + lifted); lifted may be null.
struct RightHandSide {
  const double *g, *lifted;
  double* b;
  BB_HD void operator()(Index i) const { b[i] = -(lifted ? g[i] + lifted[i] : g[i]); }
};

/// y += x.
struct AddColumn {
  const double* x;
  double* y;
  BB_HD void operator()(Index i) const { y[i] += x[i]; }
};

/// y *= factor.
struct ScaleColumn {
  double factor;
  double* y;
  BB_HD void operator()(Index i) const { y[i] *= factor; }
};

/// Largest length of a column of three numbers.
struct ColumnNorms {
  const double* x;
  BB_HD Key operator()(Index v) const {
    using std::sqrt;
    return largest_key(sqrt(x[3 * v] * x[3 * v] + x[3 * v + 1] * x[3 * v + 1] + x[3 * v + 2] * x[3 * v + 2]));
  }
};

}  // namespace bb::resident
