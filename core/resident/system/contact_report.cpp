// What the resident contact says of a state, numbers of rows in one pass, and what it remembers from step to step.
#include <array>
#include <cmath>

#include "core/archive/archive.hpp"
#include "core/contact/contact_key.hpp"
#include "core/resident/system/resident_contact.hpp"
#include "core/terms/contact.hpp"
#include "core/terms/known_step.hpp"

namespace bb::resident {
namespace {

ContactCounts counts_of(const RowTotals& rows) {
  const auto of_kind = [&rows](std::size_t kind) { return static_cast<std::size_t>(rows.of_kind[kind]); };
  ContactCounts out;
  out.point_point = of_kind(0);
  out.point_edge = of_kind(1);
  out.point_triangle = of_kind(2);
  out.edge_edge = of_kind(3);
  out.obstacle = of_kind(4) + of_kind(5) + of_kind(6);
  out.mollified = of_kind(mollified_kind);
  return out;
}

ContactKey key_of(const HostRows& rows, std::size_t r) {
  const std::size_t n = rows.size();
  return row_key(rows.pair[r],
                 {rows.vertex[r], rows.vertex[n + r], rows.vertex[2 * n + r], rows.vertex[3 * n + r]});
}

void list_loads(const HostRows& rows, std::vector<ContactLoad>& out) {
  out.clear();
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (rows.kind[r] == mollified_kind || !(rows.push[r] < 0)) continue;
    out.push_back({key_of(rows, r), rows.d[r] / rows.d_hat[r], -rows.push[r]});
  }
}

template <class Numbers>
void fill_numbers(const RowTotals& rows, Numbers& out) {
  out.contacts = counts_of(rows);
  out.kappa_min_N_per_m = smallest_of(rows.kappa_min);
  out.kappa_max_N_per_m = largest_of(rows.kappa_max);
  out.contact_load_max_N = largest_of(rows.load_max);
}

}  // namespace

void ResidentContact::report(const Column& x, IterateNumbers& out, PhaseClock&) {
  out.kappa_change_rel = says_change_ ? stiffness_.change() : 0;
  if (rows(x).size() == 0) return;
  const RowTotals found = totals(x);
  fill_numbers(found, out);
  out.gap_min_iterates_m = rows_.min_gap;
  out.gap_min_iterates_rel = smallest_of(found.gap_rel_min);
  out.contact_curvature_max_N_per_m = largest_of(found.curvature_max);
}

void ResidentContact::report_end(const Column& x, StepNumbers& out) {
  if (rows(x).size() == 0) return;
  const RowTotals found = totals(x);
  fill_numbers(found, out);
  out.contact_load_sum_N = found.load.value();
  list_loads(rows_.on_host(), out.contact_loads);
  out.gap_min_m = rows_.min_gap;
  out.gap_min_rel = smallest_of(found.gap_rel_min);
  const double largest = vectors_.max(x);
  out.gap_min_ulps = rows_.min_gap / (std::nextafter(largest, 2 * largest) - largest);
}

void ResidentContact::add_known(KnownStep& out) const { out.stiffness = stiffness_.known(); }

// As ContactTerm::keep, which reads it; park, which is read of the later of two step ends only, is 0.
void ResidentContact::keep(Archive& archive) {
  ResidentTerm::keep(archive);
  bool started = policy_start_.started();
  std::vector<Key> pair;
  std::vector<double> gap;
  gaps_.download(pair, gap);
  std::vector<PairGap> gaps;
  for (std::size_t i = 0; i < pair.size(); ++i) gaps.push_back({pair[i], gap[i], 0});
  archive(started, gaps);
  options_.stiffness->keep(archive);
  if (!archive.reads()) return;
  policy_start_.set_started(started);
  pair.clear(), gap.clear();
  for (const PairGap& each : gaps) pair.push_back(each.pair), gap.push_back(each.gap);
  gaps_.upload(pair, gap);
}

}  // namespace bb::resident
