// What a Newton iteration does with whole columns beside the operations of vectors.hpp, and what is said of contact rows.
#pragma once

#include "core/resident/contact/resident_rows.hpp"
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

enum class RowNumber : int { gap_rel, kappa, load, curvature };

/// A number of every row. Loads and curvatures are those of rows that are not mollified.
struct RowNumbers {
  RowView rows;
  RowNumber which;
  BB_HD double number(Index r) const {
    switch (which) {
      case RowNumber::gap_rel:
        return rows.d[r] / rows.d_hat[r];
      case RowNumber::kappa:
        return rows.kappa_of(r);
      case RowNumber::load:
        return rows.mollified(r) ? 0 : -rows.push[r];
      case RowNumber::curvature:
        break;
    }
    return rows.mollified(r) ? 0 : rows.stretch[r];
  }
};
struct LargestRow {
  RowNumbers of;
  BB_HD Key operator()(Index r) const { return largest_key(of.number(r)); }
};
struct SmallestRow {
  RowNumbers of;
  BB_HD Key operator()(Index r) const { return smallest_key(of.number(r)); }
};
struct SumOfLoads {
  RowNumbers of;
  BB_HD void operator()(Index r, Compensated& sum) const { sum.add(of.number(r)); }
};
/// Rows of a kind count 1.
struct CountOfKind {
  RowView rows;
  std::uint8_t kind;
  BB_HD void operator()(Index r, Compensated& sum) const {
    if (rows.kind[r] == kind) sum.add(1);
  }
};

}  // namespace bb::resident
