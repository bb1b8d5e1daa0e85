// What is said of contact rows, in one pass over them: how many of each kind, extremes, the sum of the loads.
#pragma once

#include <limits>

#include "core/resident/contact/resident_rows.hpp"
#include "core/resident/sums/sum_kernels.hpp"

namespace bb::resident {

/// Of extremes the complement of their key (sum_kernels.hpp), so that the greatest wins; 0: there is no row.
struct RowTotals {
  Key gap_rel_min, kappa_min, kappa_max, load_max, curvature_max;
  Key of_kind[mollified_kind + 1];  // rows
  Compensated load;                 // N

  BB_HD static RowTotals zero() { return {0, 0, 0, 0, 0, {0, 0, 0, 0, 0, 0, 0, 0}, Compensated::zero()}; }
  BB_HD static void raise(Key& most, Key key) { most = key > most ? key : most; }
  friend BB_HD RowTotals operator+(const RowTotals& a, const RowTotals& b) {
    RowTotals out = a;
    raise(out.gap_rel_min, b.gap_rel_min);
    raise(out.kappa_min, b.kappa_min);
    raise(out.kappa_max, b.kappa_max);
    raise(out.load_max, b.load_max);
    raise(out.curvature_max, b.curvature_max);
    for (int kind = 0; kind <= mollified_kind; ++kind) out.of_kind[kind] += b.of_kind[kind];
    out.load = a.load + b.load;
    return out;
  }
};

/// 0 without rows.
inline double largest_of(Key most) { return most == 0 ? 0 : from_largest_key(~most); }
/// Infinity without rows.
inline double smallest_of(Key most) {
  return most == 0 ? std::numeric_limits<double>::infinity() : from_smallest_key(~most);
}

/// Parts of SumParts. Loads and curvatures are those of rows that are not mollified.
struct TotalsOfRows {
  using Sum = RowTotals;
  RowView rows;
  BB_HD void operator()(Index r, RowTotals& sum) const {
    const bool mollified = rows.mollified(r);
    const double kappa = rows.kappa_of(r), load = mollified ? 0 : -rows.push[r];
    RowTotals::raise(sum.gap_rel_min, ~smallest_key(rows.d[r] / rows.d_hat[r]));
    RowTotals::raise(sum.kappa_min, ~smallest_key(kappa));
    RowTotals::raise(sum.kappa_max, ~largest_key(kappa));
    RowTotals::raise(sum.load_max, ~largest_key(load));
    RowTotals::raise(sum.curvature_max, ~largest_key(mollified ? 0 : rows.stretch[r]));
    for (int kind = 0; kind <= mollified_kind; ++kind) sum.of_kind[kind] += rows.kind[r] == kind ? 1 : 0;
    sum.load.add(load);
  }
};

}  // namespace bb::resident
