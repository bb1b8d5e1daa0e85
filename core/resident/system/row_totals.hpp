// What is said of contact rows, in one pass over them: how many of each kind, extremes, the sum of the loads.
#pragma once

#include <limits>

#include "core/exec/sums/sum_kernels.hpp"
#include "core/resident/contact/resident_rows.hpp"
#include "core/resident/contact/sum_kernels.hpp"

namespace bb::resident {

/// Of extremes the complement of their key (sum_kernels.hpp), so that the greatest wins; 0: there is no row.
struct RowTotals {
  Key gap_rel_min, kappa_min, kappa_max, load_max, curvature_max;
  Key of_kind[mollified_kind + 1];  // rows
  Compensated load;                 // N
  Compensated energy;               // J, mollifiers included

  BB_HD static RowTotals zero() {
    return {0, 0, 0, 0, 0, {0, 0, 0, 0, 0, 0, 0, 0}, Compensated::zero(), Compensated::zero()};
  }
  friend BB_HD RowTotals operator+(const RowTotals& a, const RowTotals& b) {
    RowTotals out = a;
    raise_key(out.gap_rel_min, b.gap_rel_min);
    raise_key(out.kappa_min, b.kappa_min);
    raise_key(out.kappa_max, b.kappa_max);
    raise_key(out.load_max, b.load_max);
    raise_key(out.curvature_max, b.curvature_max);
    for (int kind = 0; kind <= mollified_kind; ++kind) out.of_kind[kind] += b.of_kind[kind];
    out.load = a.load + b.load;
    out.energy = a.energy + b.energy;
    return out;
  }
};

/// Parts of SumParts. Loads and curvatures are those of rows that are not mollified.
struct TotalsOfRows {
  using Sum = RowTotals;
  RowView rows;
  RowEnergy energy;
  BB_HD void operator()(Index r, RowTotals& sum) const {
    const bool mollified = rows.mollified(r);
    const double kappa = rows.kappa_of(r), load = mollified ? 0 : -rows.push[r];
    raise_key(sum.gap_rel_min, ~smallest_key(rows.d[r] / rows.d_hat[r]));
    raise_key(sum.kappa_min, ~smallest_key(kappa));
    raise_key(sum.kappa_max, ~largest_key(kappa));
    raise_key(sum.load_max, ~largest_key(load));
    raise_key(sum.curvature_max, ~largest_key(mollified ? 0 : rows.stretch[r]));
    for (int kind = 0; kind <= mollified_kind; ++kind) sum.of_kind[kind] += rows.kind[r] == kind ? 1 : 0;
    sum.load.add(load);
    energy(r, sum.energy);
  }
};

}  // namespace bb::resident
