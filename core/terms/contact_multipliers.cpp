#include "core/terms/contact_multipliers.hpp"

#include <algorithm>
#include <cmath>

namespace bb {

void ContactMultipliers::begin_step() {
  entries_.clear();
  updates_ = 0;
  penalty_ = rules_.initial > 0 ? rules_.initial : 10;
}

void ContactMultipliers::set_scale(double energy) {
  if (rules_.initial > 0) return;
  penalty_ = std::min(10 * std::max(1.0, 2 * std::abs(energy)), rules_.largest);
}

const ContactMultipliers::Entry* ContactMultipliers::find(const PairId& pair) const {
  const auto at = std::lower_bound(entries_.begin(), entries_.end(), pair,
                                   [](const Entry& entry, const PairId& of) { return entry.pair < of; });
  return at != entries_.end() && at->pair == pair ? &*at : nullptr;
}

template <class Table>
void ContactMultipliers::fill(Table& rows) const {
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Entry* known = find(rows.pair[r]);
    const double penalty = known ? known->penalty : penalty_, force = known ? known->force : 0;
    const double pushed = std::max(0.0, force / penalty - rows.d[r]);
    rows.kappa[r] = penalty;
    rows.b[r] = 0.5 * pushed * pushed;
    rows.db[r] = -pushed;
    rows.d2b[r] = pushed > 0 ? 1 : 0;
  }
}
template void ContactMultipliers::fill(ContactTable&) const;
template void ContactMultipliers::fill(MollifiedTable&) const;

ContactMultipliers::Entry ContactMultipliers::updated(const Entry& before, double d, double d_hat) const {
  Entry next = before;
  next.force = std::min(std::max(0.0, before.force - before.penalty * d), rules_.largest_force);
  next.violation = std::max(0.0, -d);
  if (next.violation > rules_.reduction * before.violation) {
    next.penalty = std::min(before.penalty * rules_.factor, rules_.largest);
  }
  next.penalty = std::max(next.penalty, next.force / d_hat);
  return next;
}

template <class Table>
void ContactMultipliers::collect(const Table& rows) {
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Entry* known = find(rows.pair[r]);
    // of a new pair: what it violated at the start of the step, which was nothing
    const Entry next =
        updated(known ? *known : Entry{rows.pair[r], 0, penalty_, 0}, rows.d[r], rows.d_hat[r]);
    off_ = std::max({off_, next.violation, std::abs(std::min(rows.d[r], next.force))});
    next_.push_back(next);
  }
}

bool ContactMultipliers::update(const ContactTable& rows, const MollifiedTable& mollified) {
  next_.clear();
  off_ = 0;
  collect(rows);
  collect(mollified);
  const auto by_pair = [](const Entry& a, const Entry& b) { return a.pair < b.pair; };
  std::sort(next_.begin(), next_.end(), by_pair);
  const auto n = static_cast<std::ptrdiff_t>(next_.size());
  for (const Entry& entry : entries_) {  // beyond d_hat a pair bears nothing any more
    if (std::binary_search(next_.begin(), next_.begin() + n, entry, by_pair)) continue;
    next_.push_back({entry.pair, 0, entry.penalty, 0});
  }
  std::sort(next_.begin(), next_.end(), by_pair);
  if (off_ < rules_.tolerance_m) return false;
  entries_.swap(next_);
  ++updates_;
  return true;
}

}  // namespace bb
