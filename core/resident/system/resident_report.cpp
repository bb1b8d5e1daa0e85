// What is said of a state: numbers of the reports by reductions, everything else through the CPU's view of it.
#include <cmath>
#include <limits>

#include "core/archive/archive.hpp"
#include "core/resident/system/resident_system.hpp"
#include "core/resident/system/system_kernels.hpp"
#include "core/terms/contact.hpp"

namespace bb::resident {
namespace {

class RowReport {
 public:
  RowReport(ResidentRows& rows, ResidentSum& sum, ResidentLeast& least)
      : view_(rows.view()), sum_(sum), least_(least) {}

  double largest(RowNumber which) const {
    least_.clear();
    least_.add(view_.n, LargestRow{{view_, which}});
    return least_.largest();
  }
  double smallest(RowNumber which) const {
    least_.clear();
    least_.add(view_.n, SmallestRow{{view_, which}});
    return least_.smallest();
  }
  double load_sum() const {
    sum_.clear();
    sum_.add(view_.n, SumOfLoads{{view_, RowNumber::load}});
    return sum_.get().value();
  }
  ContactCounts counts() const {
    ContactCounts out;
    std::size_t* const of_kind[] = {&out.point_point, &out.point_edge, &out.point_triangle,
                                    &out.edge_edge,   &out.obstacle,   &out.mollified};
    for (std::uint8_t kind = 0; kind <= mollified_kind; ++kind) {
      sum_.clear();
      sum_.add(view_.n, CountOfKind{view_, kind});
      *of_kind[kind] = static_cast<std::size_t>(sum_.get().value());
    }
    return out;
  }

 private:
  RowView view_;
  ResidentSum& sum_;
  ResidentLeast& least_;
};

template <class Numbers>
void fill(const RowReport& rows, Numbers& out) {
  out.kappa_min_N_per_m = rows.smallest(RowNumber::kappa);
  out.kappa_max_N_per_m = rows.largest(RowNumber::kappa);
  out.contact_load_max_N = rows.largest(RowNumber::load);
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
  const RowReport rows(contact_->rows(x_), sum_, least_);
  out.contacts = rows.counts();
  fill(rows, out);
  out.gap_min_iterates_m = contact_->rows(x_).min_gap;
  out.gap_min_iterates_rel = rows.smallest(RowNumber::gap_rel);
  out.contact_curvature_max_N_per_m = rows.largest(RowNumber::curvature);
}

void ResidentSystem::report_end(StepNumbers& out) const {
  if (plan_.term("strain_limit").needed) {
    const LimitNumbers limit = elements_.limit_numbers(x_.data());
    out.max_stretch = limit.max_stretch;
    out.limit_load_max_N_per_m = limit.load_max;
  }
  if (!contact_ || contact_->rows(x_).size() == 0) return;
  const RowReport rows(contact_->rows(x_), sum_, least_);
  out.contacts = rows.counts();
  fill(rows, out);
  out.contact_load_sum_N = rows.load_sum();
  out.gap_min_m = contact_->rows(x_).min_gap;
  out.gap_min_rel = rows.smallest(RowNumber::gap_rel);
  const double largest = largest_coordinate();
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

void ResidentSystem::drop_caches() { contact_matrix_ = {}; }

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
