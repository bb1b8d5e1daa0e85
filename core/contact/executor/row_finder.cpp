#include "core/contact/executor/row_finder.hpp"

#include <limits>

namespace bb::exec {

RowFinder::RowFinder(Executor& executor, const ExecutorSurface& surface, bool mollifier)
    : executor_(executor),
      surface_(surface),
      mollifier_(mollifier),
      places_(executor, "narrow phase"),
      numbers_(executor),
      differs_(executor) {}

void RowFinder::look(const PositionsView& x, const ExecutorCandidates& candidates) {
  phase_ = {surface_.view(), x.data(), mollifier_};
  lists_ = candidate_lists(candidates);
  const Index n = lists_.size();
  numbers_.fill(0);
  executor_.fill_bytes(&numbers_.to_write()->least_gap, 0xff, sizeof(Key));
  const RankRows rank{phase_, lists_, places_.room(n), places_.counts(n), x.size(), numbers_.to_write()};
  executor_.blocks(rank.n_blocks(), rank);
  places_.finish(n);
}

void RowFinder::finish(ExecutorRows& rows) {
  RowNumbers numbers{0, 0, ~Key{0}, 4 * static_cast<Key>(expected_.rows),
                     10 * static_cast<Key>(expected_.rows)};
  Index n = expected_.rows, n_mollified = expected_.mollified;
  if (!executor_.counts_only()) {
    numbers = numbers_.get();
    n = TwoPlaces::first_of(places_.sum()), n_mollified = TwoPlaces::second_of(places_.sum());
  }
  rows.min_gap = std::numeric_limits<double>::infinity();
  if (numbers.not_finite != 0) {  // comparisons mean nothing then
    n = n_mollified = 0;
    numbers.slots = numbers.contributions = 0;
    rows.min_gap = -std::numeric_limits<double>::infinity();
  }
  rows.resize(n);
  rows.n_slots = static_cast<Index>(numbers.slots),
  rows.n_contributions = static_cast<Index>(numbers.contributions);
  rows.list.fit(n_mollified);
  if (n == 0) return;
  if (numbers.least_gap != ~Key{0}) rows.min_gap = from_smallest_key(numbers.least_gap);
  executor_.each(lists_.size(), FillRows{phase_, lists_, places_.counts(lists_.size()), places_.two_places(),
                                         rows.view(), rows.list.data()});
}

void RowFinder::compare(ExecutorRows& a, ExecutorRows& b) {
  comparable_ = a.size() == b.size() && !executor_.counts_only();
  if (!comparable_) return;
  differs_.fill(0);
  executor_.each(a.size(), CompareStencils{a.view(), b.view(), differs_.to_write()});
}

}  // namespace bb::exec
