#include "core/terms/barrier_multipliers.hpp"

#include <algorithm>
#include <limits>

namespace bb {
namespace {

template <class Table>
double smallest_gap(const Table& rows) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t r = 0; r < rows.size(); ++r) least = std::min(least, rows.d[r] / rows.d_hat[r]);
  return least;
}

}  // namespace

Fade fade(double d, double d_hat) {
  const double half = d_hat / 2;
  if (d >= d_hat) return {0, 0, 0};
  if (d < half) return {half / 2 + half - d, -1, 0};
  return {(d_hat - d) * (d_hat - d) / (2 * half), -(d_hat - d) / half, 1 / half};
}

void BarrierMultipliers::begin_step() {
  entries_.clear();
  scale_ = 1;
  gap_before_ = std::numeric_limits<double>::infinity();
  counts_ = {};
}

void BarrierMultipliers::adopt(const BarrierMultipliers& other) {
  entries_ = other.entries_;
  scale_ = other.scale_;
  gap_before_ = other.gap_before_;
}

const BarrierMultipliers::Entry* BarrierMultipliers::find(const PairId& pair) const {
  const auto at = std::lower_bound(entries_.begin(), entries_.end(), pair,
                                   [](const Entry& entry, const PairId& of) { return entry.pair < of; });
  return at != entries_.end() && at->pair == pair ? &*at : nullptr;
}

template <class Table>
void BarrierMultipliers::add(Table& rows) const {
  if (entries_.empty() && scale_ == 1) return;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (!(rows.kappa[r] > 0)) continue;
    const Entry* known = find(rows.pair[r]);
    const double times = known ? 2 * scale_ : scale_, force = known ? known->force / rows.kappa[r] : 0;
    const Fade w = fade(rows.d[r], rows.d_hat[r]);
    rows.b[r] = times * rows.b[r] + force * w.value;
    rows.db[r] = times * rows.db[r] + force * w.slope;
    rows.d2b[r] = times * rows.d2b[r] + force * w.curvature;
  }
}
template void BarrierMultipliers::add(ContactTable&) const;
template void BarrierMultipliers::add(MollifiedTable&) const;

// Pairs of A' without a row any more carry nothing, and leave it.
template <class Table>
void BarrierMultipliers::collect(const Table& rows, bool join) {
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Entry* known = find(rows.pair[r]);
    if (!known && (!join || rows.d[r] >= rules_.near * rows.d_hat[r])) continue;
    const double before = known ? known->force : 0, share = known ? 2 : 1;
    const double of_barrier = -rows.force(r) + before * fade(rows.d[r], rows.d_hat[r]).slope;
    next_.push_back({rows.pair[r], before + std::max(0.0, of_barrier) / share});
  }
}

bool BarrierMultipliers::update(const ContactTable& rows, const MollifiedTable& mollified) {
  const double gap = std::min(smallest_gap(rows), smallest_gap(mollified));
  const bool closer = gap < gap_before_;
  gap_before_ = gap;
  if (gap >= rules_.release) {
    if (entries_.empty() || scale_ >= rules_.growth_most) return false;
    entries_.clear();
    ++counts_.releases;
    counts_.force_N = 0;
    return true;
  }
  if (gap >= rules_.near) return false;
  const bool join = closer || entries_.empty();
  next_.clear();
  collect(rows, join);
  collect(mollified, join);
  std::sort(next_.begin(), next_.end(), [](const Entry& a, const Entry& b) { return a.pair < b.pair; });
  entries_.swap(next_);
  scale_ = std::min(rules_.growth * scale_, rules_.growth_most);
  counts_.stiffening = scale_;
  counts_.force_N = 0;
  for (const Entry& each : entries_) counts_.force_N = std::max(counts_.force_N, each.force);
  counts_.pairs_most = std::max(counts_.pairs_most, static_cast<double>(entries_.size()));
  ++counts_.updates;
  return true;
}

}  // namespace bb
