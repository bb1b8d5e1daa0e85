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
/// Of a row without mollifier; load: kappa |b'|, N. In the order of the pairs.
void add_load(const ContactKey& key, double gap_rel, double load, StepNumbers& out);

}  // namespace bb
