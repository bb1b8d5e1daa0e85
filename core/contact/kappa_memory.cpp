#include "core/contact/kappa_memory.hpp"

#include <algorithm>

namespace bb {
namespace {

template <class Table>
void set_kappa(Table& rows, std::size_t r) {
  rows.kappa[r] = rows.parts[r].at(rows.d[r]);
}

/// (a x + b y)/n, part by part.
KappaParts combined(double a, const KappaParts& x, double b, const KappaParts& y, double n) {
  return {(a * x.fixed + b * y.fixed) / n, (a * x.per_gap_sq + b * y.per_gap_sq) / n};
}

}  // namespace

void KappaMemory::adopt(const KnownStiffness& known) {
  known_.clear();
  for (std::size_t i = 0; i < known.pair.size(); ++i) known_.push_back({known.pair[i], known.parts[i]});
}

void KappaMemory::known(KnownStiffness& out) const {
  out = {};
  for (const Known& entry : known_) {
    out.pair.push_back(entry.pair);
    out.parts.push_back(entry.parts);
  }
}

const KappaMemory::Known* KappaMemory::find(PairId pair) const {
  const auto at = std::lower_bound(known_.begin(), known_.end(), pair,
                                   [](const Known& entry, PairId id) { return entry.pair < id; });
  return at != known_.end() && at->pair == pair ? &*at : nullptr;
}

KappaMemory::Share KappaMemory::share(const ContactTable& rows, std::size_t row) const {
  Share out;
  for (std::size_t i = rows.pair_begin[row]; i < rows.pair_begin[row + 1]; ++i) {
    if (const Known* entry = find(rows.pair[i])) {
      out.sum.fixed += entry->parts.fixed;
      out.sum.per_gap_sq += entry->parts.per_gap_sq;
      ++out.n;
    }
  }
  return out;
}

void KappaMemory::recall(ContactTable& rows, MollifiedTable& mollified, std::vector<int>& missing,
                         std::vector<int>& missing_mollified) const {
  missing.clear();
  missing_mollified.clear();
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const std::size_t n = rows.pair_begin[r + 1] - rows.pair_begin[r];
    const Share known = share(rows, r);
    if (known.n == n) {
      rows.parts[r] = combined(1, known.sum, 0, {}, static_cast<double>(n));
      set_kappa(rows, r);
    } else {
      missing.push_back(static_cast<int>(r));
    }
  }
  for (std::size_t r = 0; r < mollified.size(); ++r) {
    if (const Known* entry = find(mollified.pair[r])) {
      mollified.parts[r] = entry->parts;
      set_kappa(mollified, r);
    } else {
      missing_mollified.push_back(static_cast<int>(r));
    }
  }
}

void KappaMemory::complete(ContactTable& rows, const std::vector<int>& missing, MollifiedTable& mollified,
                           const std::vector<int>& missing_mollified) const {
  for (const int row : missing) {
    const auto r = static_cast<std::size_t>(row);
    const Share known = share(rows, r);
    const std::size_t n = rows.pair_begin[r + 1] - rows.pair_begin[r];
    if (known.n > 0) {
      rows.parts[r] =
          combined(1, known.sum, static_cast<double>(n - known.n), rows.parts[r], static_cast<double>(n));
    }
    set_kappa(rows, r);
  }
  for (const int row : missing_mollified) set_kappa(mollified, static_cast<std::size_t>(row));
}

void KappaMemory::store(const ContactTable& rows, const MollifiedTable& mollified) {
  fresh_.clear();
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const std::size_t begin = rows.pair_begin[r], end = rows.pair_begin[r + 1];
    const Share known = share(rows, r);
    if (known.n == end - begin) continue;
    // the inverse of complete()
    const KappaParts parts = combined(static_cast<double>(end - begin), rows.parts[r], -1, known.sum,
                                      static_cast<double>(end - begin - known.n));
    for (std::size_t i = begin; i < end; ++i) {
      if (!find(rows.pair[i])) fresh_.push_back({rows.pair[i], parts});
    }
  }
  for (std::size_t r = 0; r < mollified.size(); ++r) {
    if (!find(mollified.pair[r])) fresh_.push_back({mollified.pair[r], mollified.parts[r]});
  }
  if (fresh_.empty()) return;
  const auto less = [](const Known& a, const Known& b) { return a.pair < b.pair; };
  std::sort(fresh_.begin(), fresh_.end(), less);
  merged_.resize(known_.size() + fresh_.size());
  std::merge(known_.begin(), known_.end(), fresh_.begin(), fresh_.end(), merged_.begin(), less);
  known_.swap(merged_);
}

}  // namespace bb
