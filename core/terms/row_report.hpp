// What an iterate and the end of a step say of contact rows: counts, gaps, kappa, loads. Where there are none nothing is said.
#pragma once

#include "core/contact/row_totals.hpp"
#include "core/math/precision.hpp"
#include "core/terms/report.hpp"

namespace bb {

/// gap_min: the smallest gap of the rows, m.
void report_rows(const RowTotals& rows, double gap_min, IterateNumbers& out);
/// largest: the largest coordinate of the state in magnitude, m, in units of whose last place a gap is told.
void report_rows(const RowTotals& rows, double gap_min, double largest, Precision precision,
                 StepNumbers& out);

/// A row at the end of a step.
struct EndRow {
  PairId pair;
  ContactKey key;
  double d, d_hat;  // m
  double load;      // kappa |b'|, N
  bool mollified;
};
/// Its load, where it has one and no mollifier. In the order of the pairs.
void add_load(const EndRow& row, StepNumbers& out);

}  // namespace bb
