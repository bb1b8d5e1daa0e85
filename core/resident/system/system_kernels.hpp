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

}  // namespace bb::resident
