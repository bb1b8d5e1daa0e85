// The stiffness of rows that were there before, found again by identity.
#include "core/contact/kappa_entry.hpp"

namespace bb {

template <class Table>
void KappaMemory::add(const Table& table) {
  if (table.size() == 0) return;
  merged_.clear();
  const auto append = [&](const Entry& e) {
    if (merged_.empty() || merged_.back().before(e)) merged_.push_back(e);
  };
  std::size_t known = 0;
  for (std::size_t r = 0; r < table.size(); ++r) {
    const Entry e = entry(table, r);
    while (known < entries_.size() && !e.before(entries_[known])) append(entries_[known++]);
    append(e);
  }
  while (known < entries_.size()) append(entries_[known++]);
  entries_.swap(merged_);
}

void KappaMemory::store(const ContactTable& rows, const MollifiedTable& mollified) {
  add(rows);
  add(mollified);
}

template <class Table>
void KappaMemory::fill(Table& table, std::vector<int>& missing) const {
  missing.clear();
  std::size_t known = 0;
  for (std::size_t r = 0; r < table.size(); ++r) {
    const Entry e = entry(table, r);
    while (known < entries_.size() && entries_[known].before(e)) ++known;
    if (known < entries_.size() && !e.before(entries_[known])) {
      table.kappa[r] = entries_[known].kappa;
    } else {
      missing.push_back(static_cast<int>(r));
    }
  }
}

void KappaMemory::recall(ContactTable& rows, MollifiedTable& mollified, std::vector<int>& missing,
                         std::vector<int>& missing_mollified) const {
  fill(rows, missing);
  fill(mollified, missing_mollified);
}

}  // namespace bb
