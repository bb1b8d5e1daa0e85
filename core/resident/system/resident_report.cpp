// What is said of a state: numbers of rows in one pass, everything else through the CPU's view of it.
#include <array>
#include <cmath>

#include "core/archive/archive.hpp"
#include "core/contact/contact_row.hpp"
#include "core/resident/system/resident_system.hpp"
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
  constexpr Key index = (Key{1} << 30) - 1;
  const std::size_t n = rows.size();
  ContactKey key = {rows.vertex[r], rows.vertex[n + r], rows.vertex[2 * n + r], rows.vertex[3 * n + r]};
  if (rows.kind[r] == mollified_kind || !is_obstacle(static_cast<ContactKind>(rows.kind[r]))) return key;
  return obstacle_key(static_cast<int>(rows.pair[r] & index), std::array{key[0], key[1], key[2]});
}

void list_loads(const HostRows& rows, std::vector<ContactLoad>& out) {
  out.clear();
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (rows.kind[r] == mollified_kind || !(rows.push[r] < 0)) continue;
    out.push_back({key_of(rows, r), rows.d[r] / rows.d_hat[r], -rows.push[r]});
  }
}

template <class Numbers>
void fill(const RowTotals& rows, Numbers& out) {
  out.contacts = counts_of(rows);
  out.kappa_min_N_per_m = smallest_of(rows.kappa_min);
  out.kappa_max_N_per_m = largest_of(rows.kappa_max);
  out.contact_load_max_N = largest_of(rows.load_max);
}

}  // namespace

double ResidentSystem::energy() const {
  sum_.clear();
  elements_.add_energy(TermSet::all(), x_.data(), sum_);
  const double fixed = sum_.get().value();
  return contact_ ? fixed + contact_->energy(x_).value() : fixed;
}

double ResidentSystem::energy(TermGroup group) const {
  if (group == TermGroup::contact) return contact_ ? contact_->energy(x_).value() : 0;
  sum_.clear();
  elements_.add_energy(group, x_.data(), sum_);
  return sum_.get().value();
}

RowTotals ResidentSystem::row_totals() const {
  const RowView rows = contact_->rows(x_).view();
  row_totals_.clear();
  row_totals_.add(rows.n, TotalsOfRows{rows});
  return row_totals_.get();
}

void ResidentSystem::report(IterateNumbers& out) const {
  if (plan_.term("strain_limit").needed) {
    const ScopedPhase timer(clock(), Phase::strain_limit);
    const LimitNumbers limit = elements_.limit_numbers(x_.data());
    out.max_stretch = limit.max_stretch;
    out.limit_load_max_N_per_m = limit.load_max;
    out.limit_kappa_change_rel = limit_kappa_change_;
    out.limit_gap_min_rel = limit.gap_min_rel;
  }
  if (!contact_) return;
  out.kappa_change_rel = contact_->kappa_change();
  if (contact_->rows(x_).size() == 0) return;
  const RowTotals rows = row_totals();
  fill(rows, out);
  out.gap_min_iterates_m = contact_->rows(x_).min_gap;
  out.gap_min_iterates_rel = smallest_of(rows.gap_rel_min);
  out.contact_curvature_max_N_per_m = largest_of(rows.curvature_max);
}

void ResidentSystem::report_end(StepNumbers& out) const {
  if (plan_.term("strain_limit").needed) {
    const LimitNumbers limit = elements_.limit_numbers(x_.data());
    out.max_stretch = limit.max_stretch;
    out.limit_load_max_N_per_m = limit.load_max;
  }
  if (!contact_ || contact_->rows(x_).size() == 0) return;
  const RowTotals rows = row_totals();
  fill(rows, out);
  out.contact_load_sum_N = rows.load.value();
  list_loads(contact_->rows(x_).on_host(), out.contact_loads);
  out.gap_min_m = contact_->rows(x_).min_gap;
  out.gap_min_rel = smallest_of(rows.gap_rel_min);
  const double largest = vectors_.max(x_);
  out.gap_min_ulps = contact_->rows(x_).min_gap / (std::nextafter(largest, 2 * largest) - largest);
}

void ResidentSystem::report_overload(bool with_direction, StepNumbers& out) {
  Positions dx = Positions::Zero(3, x().cols());
  if (with_direction) dx_.download({dx.data(), static_cast<std::size_t>(dx.size())});
  static_cast<const NewtonSystem&>(on_cpu()).report_overload(dx, out);
}

std::string ResidentSystem::describe_non_finite() const {
  const ResidentElements::BadElement bad = elements_.first_not_finite();
  if (bad.element >= 0) return "element " + std::to_string(bad.element) + " of term " + std::string(bad.term);
  if (const Index i = vectors_.first_not_finite(g_); i >= 0)
    return "gradient at vertex " + std::to_string(i / 3);
  if (const Index i = vectors_.first_not_finite(dx_); i >= 0)
    return "direction at vertex " + std::to_string(i / 3);
  return "a sum over all vertices";
}

// Memory of the terms from step to step, in the order of NewtonSystem::keep, which reads it; park, which is read of the
// later of two step ends only, is 0.
void ResidentSystem::keep(Archive& archive) {
  for (const auto& term : cpu().terms()) {
    archive.section(term->name());
    if (contact_ && term->group() == TermGroup::contact) {
      keep_contact(archive);
    } else {
      term->keep(archive);
    }
  }
}

void ResidentSystem::keep_contact(Archive& archive) {
  bool started = contact_->policy_started();
  std::vector<Key> pair;
  std::vector<double> gap;
  contact_->step_end_gaps().download(pair, gap);
  std::vector<PairGap> gaps;
  for (std::size_t i = 0; i < pair.size(); ++i)
    gaps.push_back({pair[i], gap[i], 0});  // park is read of the later end
  archive(started, gaps);
  method_.stiffness->keep(archive);
  if (!archive.reads()) return;
  contact_->set_policy_started(started);
  pair.clear(), gap.clear();
  for (const PairGap& each : gaps) pair.push_back(each.pair), gap.push_back(each.gap);
  contact_->step_end_gaps().upload(pair, gap);
}

// The clusters of a preconditioner go with the pattern that they were made for.
void ResidentSystem::drop_caches() {
  contact_matrix_ = {};
  ++pattern_id_;
}

NewtonSystem& ResidentSystem::cpu() {
  if (!cpu_) cpu_ = std::make_unique<NewtonSystem>(scene_, method_, plan_);
  return *cpu_;
}

NewtonSystem& ResidentSystem::on_cpu() {
  Archive memory;
  keep(memory);
  Archive again(memory.bytes());
  cpu().keep(again);
  KnownStiffness known;
  if (contact_) known = contact_->stiffness().known();
  cpu().adopt({x_start_, prediction_.x_tilde, frame_.dt, prediction_.c, frame_.load_factor}, x(), target_,
              level_, known);
  return cpu();
}

}  // namespace bb::resident
