// What an iterate and the end of a step report of contact rows: counts, gaps, kappa, loads. Without rows nothing is reported.
#pragma once

#include "core/contact/row_totals.hpp"
#include "core/math/precision.hpp"
#include "core/terms/report.hpp"

namespace bb {

/// gap_min: the smallest gap of the rows, m.
void report_rows(const RowTotals& rows, double gap_min, IterateNumbers& out);
/// largest: the largest coordinate of the state in magnitude, m, in units of whose last place a gap is reported.
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

/// The end of a step whose rows have these totals. largest(), as above, and visit(f), which calls f(each EndRow), are called where there
/// are rows; those without mollifier come in the order of their pairs.
template <class Largest, class Visit>
void report_rows_of_end(const RowTotals& rows, double gap_min, Precision precision, const Largest& largest,
                        const Visit& visit, StepNumbers& out) {
  out.contact_loads.clear();
  const bool any = rows.size() > 0;
  report_rows(rows, gap_min, any ? largest() : 0, precision, out);
  if (any) visit([&out](const EndRow& row) { add_load(row, out); });
}

}  // namespace bb
