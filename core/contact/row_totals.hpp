// What is reported of contact rows, in one pass over them: how many of each kind, extremes, the sum of the loads.
#pragma once

#include "core/contact/contact_table.hpp"
#include "core/exec/sums/sum_kernels.hpp"

namespace bb {

/// What is read of one.
struct ReportedRow {
  std::uint8_t kind;        // ContactKind or mollified_kind
  double d, d_hat;          // m
  double kappa;             // N/m
  double force, stiffness;  // kappa b' (N), kappa b'' (N/m)
};

/// Sums of rows in any order but for the last digits of the loads. Of extremes the complement of their key (sum_kernels.hpp), so that
/// the greatest wins, and NaN beats all; 0: there is no row.
struct RowTotals {
  exec::Key gap_rel_min, kappa_min, kappa_max, load_max, curvature_max;
  exec::Key of_kind[mollified_kind + 1];  // rows
  exec::Compensated load;                 // N
  exec::Compensated energy;               // J, mollifiers included; of rows in an executor's memory

  BB_HD static RowTotals zero() {
    constexpr auto none = exec::Compensated{0, 0, 0};
    return {0, 0, 0, 0, 0, {0, 0, 0, 0, 0, 0, 0, 0}, none, none};
  }
  BB_HD exec::Key size() const {
    exec::Key n = 0;
    for (const exec::Key of : of_kind) n += of;
    return n;
  }
  /// Loads and curvatures are those of rows that are not mollified: a mollified one has e(x) kappa |b'| and no load of its own.
  BB_HD void add(const ReportedRow& row) {
    using namespace exec;
    const bool mollified = row.kind == mollified_kind;
    const double load_of_row = mollified ? 0 : -row.force;
    raise_key(gap_rel_min, ~smallest_key(row.d / row.d_hat));
    raise_key(kappa_min, ~smallest_key(row.kappa));
    raise_key(kappa_max, ~largest_key(row.kappa));
    raise_key(load_max, ~largest_key(load_of_row));
    raise_key(curvature_max, ~largest_key(mollified ? 0 : row.stiffness));
    for (int kind = 0; kind <= mollified_kind; ++kind) of_kind[kind] += row.kind == kind ? 1 : 0;
    load.add(load_of_row);
  }
  friend BB_HD RowTotals operator+(const RowTotals& a, const RowTotals& b) {
    using exec::raise_key;
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

}  // namespace bb
