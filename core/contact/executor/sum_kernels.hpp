// What is summed over rows.
#pragma once

#include "core/contact/executor/executor_rows.hpp"
#include "core/contact/executor/mollified_column.hpp"
#include "core/contact/row_totals.hpp"
#include "core/exec/sums/sum_kernels.hpp"

namespace bb::exec {

/// Energy of a row, J, mollifier included.
struct RowEnergy {
  RowView rows;
  MollifiedColumn mollifier;  // [n], one number each
  BB_HD void operator()(Index r, Compensated& sum) const {
    const double e = rows.energy[r];
    sum.add(rows.mollified(r) ? mollifier.number[mollifier.of(r)] * e : e);
  }
};

/// Mass of the free vertices of a row, kg, and how many they are.
struct RowMass {
  RowView rows;
  const double* mass;
  BB_HD void operator()(Index r, Compensated& sum) const {
    double row = 0;
    for (int k = 0; k < 4; ++k) {
      if (rows.is_free(r, k)) row += mass[rows.vertex[k * rows.n + r]];
    }
    sum.add(row);
  }
};
struct RowPoints {
  RowView rows;
  BB_HD void operator()(Index r, Compensated& sum) const { sum.add(rows.n_free(r)); }
};

/// What is reported of the rows.
struct TotalsOfRows {
  using Sum = RowTotals;
  RowView rows;
  RowEnergy energy;
  BB_HD void operator()(Index r, RowTotals& sum) const {
    sum.add({rows.kind[r], rows.d[r], rows.d_hat[r], rows.kappa_of(r), rows.force[r], rows.stiffness[r]});
    energy(r, sum.energy);
  }
};

}  // namespace bb::exec
