#include "core/contact/kappa_memory.hpp"

namespace bb {
namespace {

template <class Table>
void recall_table(const KnownStiffness& known, Table& rows, std::vector<int>& missing) {
  missing.clear();
  std::size_t k = 0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    while (k < known.pair.size() && known.pair[k] < rows.pair[r]) ++k;
    if (k == known.pair.size() || known.pair[k] != rows.pair[r]) {
      missing.push_back(static_cast<int>(r));
      continue;
    }
    rows.parts[r] = known.parts[k];
    rows.kappa[r] = rows.parts[r].at(rows.d[r]);
  }
}

/// out = the known pairs and those of the rows that are not known.
template <class Table>
void merge(const KnownStiffness& known, const Table& rows, KnownStiffness& out) {
  out.pair.clear(), out.parts.clear();
  const auto add = [&out](PairId pair, const KappaParts& parts) {
    out.pair.push_back(pair), out.parts.push_back(parts);
  };
  std::size_t k = 0, r = 0;
  while (k < known.pair.size() || r < rows.size()) {
    if (k == known.pair.size() || (r < rows.size() && rows.pair[r] < known.pair[k])) {
      add(rows.pair[r], rows.parts[r]);
      ++r;
    } else {
      if (r < rows.size() && rows.pair[r] == known.pair[k]) ++r;
      add(known.pair[k], known.parts[k]);
      ++k;
    }
  }
}

}  // namespace

void KappaMemory::recall(ContactTable& rows, MollifiedTable& mollified, std::vector<int>& missing,
                         std::vector<int>& missing_mollified) const {
  recall_table(known_, rows, missing);
  recall_table(known_, mollified, missing_mollified);
}

void KappaMemory::store(const ContactTable& rows, const MollifiedTable& mollified) {
  merge(known_, rows, merged_);
  merge(merged_, mollified, known_);
}

}  // namespace bb
