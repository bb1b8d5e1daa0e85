// What is said of a state: numbers of rows in one pass.
#include <array>
#include <cmath>

#include "core/archive/archive.hpp"
#include "core/contact/contact_key.hpp"
#include "core/resident/system/resident_potential.hpp"
#include "core/terms/contact.hpp"

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

double ResidentPotential::energy(TermSet set, const Column& x) {
  know_energies(x);
  sum_.clear();
  elements_.add_energy(set, x.data(), sum_);
  const double fixed = sum_.get().value();
  return contact_ && set.has(TermGroup::contact) ? fixed + contact_->energy(x).value() : fixed;
}

RowTotals ResidentPotential::row_totals(const Column& x) {
  const RowView rows = contact_->rows(x).view();
  row_totals_.clear();
  row_totals_.add(rows.n, TotalsOfRows{rows});
  return row_totals_.get();
}

void ResidentPotential::report(const Column& x, IterateNumbers& out) {
  if (plan_.term("strain_limit").needed) {
    const ScopedPhase timer(clock(), Phase::strain_limit);
    const LimitNumbers limit = elements_.limit_numbers(x.data());
    out.max_stretch = limit.max_stretch;
    out.limit_load_max_N_per_m = limit.load_max;
    out.limit_kappa_change_rel = limit_kappa_change_;
    out.limit_gap_min_rel = limit.gap_min_rel;
  }
  if (!contact_) return;
  out.kappa_change_rel = contact_->kappa_change();
  if (contact_->rows(x).size() == 0) return;
  const RowTotals rows = row_totals(x);
  fill_numbers(rows, out);
  out.gap_min_iterates_m = contact_->rows(x).min_gap;
  out.gap_min_iterates_rel = smallest_of(rows.gap_rel_min);
  out.contact_curvature_max_N_per_m = largest_of(rows.curvature_max);
}

void ResidentPotential::report_end(const Column& x, StepNumbers& out) {
  if (plan_.term("strain_limit").needed) {
    const LimitNumbers limit = elements_.limit_numbers(x.data());
    out.max_stretch = limit.max_stretch;
    out.limit_load_max_N_per_m = limit.load_max;
  }
  if (!contact_ || contact_->rows(x).size() == 0) return;
  const RowTotals rows = row_totals(x);
  fill_numbers(rows, out);
  out.contact_load_sum_N = rows.load.value();
  list_loads(contact_->rows(x).on_host(), out.contact_loads);
  out.gap_min_m = contact_->rows(x).min_gap;
  out.gap_min_rel = smallest_of(rows.gap_rel_min);
  const double largest = vectors_.max(x);
  out.gap_min_ulps = contact_->rows(x).min_gap / (std::nextafter(largest, 2 * largest) - largest);
}

std::string ResidentPotential::describe_non_finite() {
  const ResidentElements::BadElement bad = elements_.first_not_finite();
  if (bad.element < 0) return {};
  return "element " + std::to_string(bad.element) + " of term " + std::string(bad.term);
}

KnownStiffness ResidentPotential::known_stiffness() const {
  return contact_ ? contact_->stiffness().known() : KnownStiffness();
}

// Memory of the terms from step to step, in the order of HostPotential::keep, which reads it; park, which is read of the
// later of two step ends only, is 0.
void ResidentPotential::keep(Archive& archive) {
  for (std::size_t i = 0; i < plan_.terms.size(); ++i) {
    if (!plan_.terms[i].needed) continue;
    archive.section(term_entries()[i].name);
    if (contact_ && term_entries()[i].name == std::string_view("contact")) keep_contact(archive);
  }
}

void ResidentPotential::keep_contact(Archive& archive) {
  bool started = contact_->policy_start().started();
  std::vector<Key> pair;
  std::vector<double> gap;
  contact_->step_end_gaps().download(pair, gap);
  std::vector<PairGap> gaps;
  for (std::size_t i = 0; i < pair.size(); ++i)
    gaps.push_back({pair[i], gap[i], 0});  // park is read of the later end
  archive(started, gaps);
  method_.stiffness->keep(archive);
  if (!archive.reads()) return;
  contact_->policy_start().set_started(started);
  pair.clear(), gap.clear();
  for (const PairGap& each : gaps) pair.push_back(each.pair), gap.push_back(each.gap);
  contact_->step_end_gaps().upload(pair, gap);
}

}  // namespace bb::resident
