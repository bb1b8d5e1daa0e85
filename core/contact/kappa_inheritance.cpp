// The stiffness of a row whose contact was another row before: the closest point crossed to a neighbouring
// feature of the same two surfaces.
#include <algorithm>
#include <span>

#include "core/contact/kappa_entry.hpp"

namespace bb {
namespace {

struct Sides {
  std::span<const int> first, second;
};

// The vertices of the two primitives of a row; an obstacle has none.
Sides sides(ContactKind kind, const std::array<int, 4>& stencil) {
  const auto used = static_cast<std::size_t>(
      std::count_if(stencil.begin(), stencil.end(), [](int vertex) { return vertex >= 0; }));
  const std::size_t split = kind == ContactKind::edge_edge ? 2 : 1;
  const std::span<const int> all(stencil.data(), used);
  return {all.first(std::min(split, used)), all.subspan(std::min(split, used))};
}

int shared(std::span<const int> a, std::span<const int> b) {
  int n = 0;
  for (const int vertex : a) n += std::find(b.begin(), b.end(), vertex) != b.end() ? 1 : 0;
  return n;
}

// Vertices in common when each side meets one of the other row's sides, else 0.
int overlap(const Sides& a, const Sides& b) {
  const auto both = [](int x, int y) { return x > 0 && y > 0 ? x + y : 0; };
  return std::max(both(shared(a.first, b.first), shared(a.second, b.second)),
                  both(shared(a.first, b.second), shared(a.second, b.first)));
}

}  // namespace

void KappaMemory::mark_present(const ContactTable& rows, const MollifiedTable& mollified) {
  present_.assign(entries_.size(), 0);
  const auto mark = [this](const auto& table) {
    for (std::size_t r = 0; r < table.size(); ++r) {
      const Entry e = entry(table, r);
      const auto at = std::lower_bound(entries_.begin(), entries_.end(), e,
                                       [](const Entry& a, const Entry& b) { return a.before(b); });
      if (at != entries_.end() && !e.before(*at))
        present_[static_cast<std::size_t>(at - entries_.begin())] = 1;
    }
  };
  mark(rows);
  mark(mollified);
}

void KappaMemory::index_vertices() {
  of_vertex_.clear();
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    for (const int vertex : entries_[i].stencil) {
      if (vertex >= 0) of_vertex_.emplace_back(vertex, static_cast<int>(i));
    }
  }
  std::sort(of_vertex_.begin(), of_vertex_.end());
}

const KappaMemory::Entry* KappaMemory::continued(const Entry& row) const {
  const Sides mine = sides(row.kind, row.stencil);
  const int needed = std::max<int>(2, static_cast<int>(mine.first.size() + mine.second.size()) - 1);
  const Entry* best = nullptr;
  int best_score = 0;
  for (const int vertex : mine.first) {  // whatever continues the contact has one of these
    auto at = std::lower_bound(of_vertex_.begin(), of_vertex_.end(), std::pair(vertex, 0));
    for (; at != of_vertex_.end() && at->first == vertex; ++at) {
      const auto i = static_cast<std::size_t>(at->second);
      const int common = overlap(mine, sides(entries_[i].kind, entries_[i].stencil));
      if (common < needed) continue;
      const int score = 2 * common + (present_[i] ? 0 : 1);
      const bool wins = score > best_score || (score == best_score && entries_[i].before(*best));
      if (!wins) continue;
      best_score = score;
      best = &entries_[i];
    }
  }
  return best;
}

template <class Table>
void KappaMemory::inherit_rows(Table& table, std::vector<int>& missing) const {
  std::size_t kept = 0;
  for (const int row : missing) {
    const auto r = static_cast<std::size_t>(row);
    if (const Entry* before = continued(entry(table, r))) {
      table.kappa[r] = before->kappa;
    } else {
      missing[kept++] = row;
    }
  }
  missing.resize(kept);
}

void KappaMemory::inherit(ContactTable& rows, MollifiedTable& mollified, std::vector<int>& missing,
                          std::vector<int>& missing_mollified) {
  if ((missing.empty() && missing_mollified.empty()) || entries_.empty()) return;
  mark_present(rows, mollified);
  index_vertices();
  inherit_rows(rows, missing);
  inherit_rows(mollified, missing_mollified);
}

}  // namespace bb
