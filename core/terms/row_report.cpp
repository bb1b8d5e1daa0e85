#include "core/terms/row_report.hpp"

#include <cmath>

namespace bb {
namespace {

std::size_t of_kind(const RowTotals& rows, ContactKind kind) {
  return static_cast<std::size_t>(rows.of_kind[static_cast<std::size_t>(kind)]);
}

ContactCounts counts_of(const RowTotals& rows) {
  ContactCounts out;
  out.point_point = of_kind(rows, ContactKind::point_point);
  out.point_edge = of_kind(rows, ContactKind::point_edge);
  out.point_triangle = of_kind(rows, ContactKind::point_triangle);
  out.edge_edge = of_kind(rows, ContactKind::edge_edge);
  for (const ContactKind kind :
       {ContactKind::obstacle, ContactKind::obstacle_edge, ContactKind::obstacle_triangle})
    out.obstacle += of_kind(rows, kind);
  out.mollified = static_cast<std::size_t>(rows.of_kind[mollified_kind]);
  return out;
}

/// Whether there are rows, and what an iterate and the end of a step both report of them.
template <class Numbers>
bool fill(const RowTotals& rows, Numbers& out) {
  out.contacts = counts_of(rows);
  if (out.contacts.total() == 0) return false;
  out.kappa_min_N_per_m = exec::smallest_of(rows.kappa_min);
  out.kappa_max_N_per_m = exec::largest_of(rows.kappa_max);
  out.contact_load_max_N = exec::largest_of(rows.load_max);
  return true;
}

}  // namespace

void report_rows(const RowTotals& rows, double gap_min, IterateNumbers& out) {
  if (!fill(rows, out)) return;
  out.gap_min_iterates_m = gap_min;
  out.gap_min_iterates_rel = exec::smallest_of(rows.gap_rel_min);
  out.contact_curvature_max_N_per_m = exec::largest_of(rows.curvature_max);
}

void report_rows(const RowTotals& rows, double gap_min, double largest, Precision precision,
                 StepNumbers& out) {
  if (!fill(rows, out)) return;
  out.contact_load_sum_N = rows.load.value();
  out.gap_min_m = gap_min;
  out.gap_min_rel = exec::smallest_of(rows.gap_rel_min);
  const double ulp = with_value_scalar(precision, [&]<class T>() -> double {
    const T at = static_cast<T>(largest);
    return std::nextafter(at, 2 * at) - at;
  });
  out.gap_min_ulps = gap_min / ulp;
}

void add_load(const EndRow& row, StepNumbers& out) {
  if (!row.mollified && row.load > 0) out.contact_loads.push_back({row.key, row.d / row.d_hat, row.load});
}

}  // namespace bb
