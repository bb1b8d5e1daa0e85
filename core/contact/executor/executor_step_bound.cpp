#include "core/contact/executor/executor_step_bound.hpp"
#include "core/contact/contact_key.hpp"

#include <algorithm>
#include <limits>

namespace bb::exec {

ExecutorStepBound::ExecutorStepBound(Executor& executor, const ExecutorSurface& surface,
                                     const StopLevel& level, const BoundBatches& batches)
    : executor_(executor),
      surface_(surface),
      level_(level),
      batches_(batches),
      total_(executor),
      largest_(executor),
      proven_(executor, "proven times"),
      places_(executor, "asked pairs"),
      asked_(executor, "asked pairs") {}

void ExecutorStepBound::start(const PositionsView& x0, const PositionsView& x1) {
  largest_.fill(0xff);
  const Index n_blocks = (2 * x0.size() + LargestCoordinate::a_block - 1) / LargestCoordinate::a_block;
  executor_.blocks(n_blocks, LargestCoordinate{x0.data(), x1.data(), x0.size(), largest_.to_write()});
  total_.clear();
  query_ = {surface_.view(), x0.data(), x1.data(), level_.park, level_.max_probes, total_.data()};
}

/// ask(begin, n) for batches of [0, n), one after another.
template <class Ask>
void ExecutorStepBound::in_batches(Index n, const Ask& ask) {
  Index length = batches_.first_asked;
  for (Index begin = 0; begin < n; begin += length) {
    if (begin > 0) length = std::min(2 * length, batches_.most_asked);
    const Index m = std::min(length, n - begin);
    total_.add(m, ask(begin));
  }
}

Index ExecutorStepBound::pairs_of_chunk(Index begin) const {
  return std::min(batches_.chunk, lists_.begin[first_obstacle_list] - begin);
}

/// Screens the pairs of a chunk and queries them at once where one batch holds them.
void ExecutorStepBound::look_at_chunk(Index begin) {
  const Index n = pairs_of_chunk(begin);
  if (proven_.size() < n) proven_.fit(n);
  if (asked_.size() < n) asked_.fit(n);
  std::uint8_t* const keep = places_.counts(n);
  places_.rank_by(n, ScreenPairs{query_, lists_, begin, proven_.data(), keep});
  executor_.each(n, KeepPairs{proven_.data(), keep, places_.places(), asked_.data()});
  const Index most = std::min(n, batches_.first_asked);
  total_.add(most, AskPairs{query_, lists_, begin, asked_.data(), places_.sum_on_executor(), most});
}

/// What one batch did not hold, early ones first. Waits.
void ExecutorStepBound::ask_rest(Index begin) {
  const Index n = executor_.counts_only() ? 0 : places_.sum();
  if (n <= std::min(pairs_of_chunk(begin), batches_.first_asked)) return;
  executor_.sort(asked_.data(), nullptr, n, 32);
  in_batches(n, [&](Index at) { return AskPairs{query_, lists_, begin, asked_.data() + at, nullptr, 0}; });
}

template <PairKind K>
void ExecutorStepBound::ask_tree(const PairSearch& search) {
  const Index n = search.second.n > 0 ? search.first.n : 0;
  in_batches(n, [&](Index at) { return AskInTree<K>{query_, search, at}; });
}

template <int N>
void ExecutorStepBound::ask_all_obstacles() {
  in_batches(surface_.view().primitives<N>().n, [&](Index at) { return AskObstaclesOf<N>{query_, at}; });
}

/// Vertices of a pair, as StepBoundFinder names it.
ContactKey ExecutorStepBound::key_of(int list, Key pair) const {
  const SurfaceView s = surface_.view();
  const auto vertices = [&]<int N>(const PrimitiveView<N>& of, Index i) {
    std::array<int, N> out;
    executor_.download(out.data(), of.vertex + N * i, sizeof out);
    return out;
  };
  const Index i = first_of(pair), j = second_of(pair);
  const int o = static_cast<int>(j);
  if (list == obstacle_pairs_of<1>) return obstacle_key(o, vertices(s.points, i));
  if (list == obstacle_pairs_of<2>) return obstacle_key(o, vertices(s.edges, i));
  if (list == obstacle_pairs_of<3>) return obstacle_key(o, vertices(s.triangles, i));
  const int point = list == static_cast<int>(PairKind::edge_edge) ? -1 : vertices(s.points, i)[0];
  if (list == static_cast<int>(PairKind::point_point))
    return pair_key(std::array{point, vertices(s.points, j)[0]});
  if (list == static_cast<int>(PairKind::point_triangle)) {
    const auto t = vertices(s.triangles, j);
    return pair_key(std::array{point, t[0], t[1], t[2]});
  }
  const auto b = vertices(s.edges, j);
  if (point >= 0) return pair_key(std::array{point, b[0], b[1]});
  const auto a = vertices(s.edges, i);
  return pair_key(std::array{a[0], a[1], b[0], b[1]});
}

/// A motion that is not finite has the bound 0, whatever its pairs say.
StepBound ExecutorStepBound::result() {
  StepBound out;
  if (executor_.counts_only()) return out;
  const Key largest = largest_.get();
  if (~largest >= ordered_bits(std::numeric_limits<double>::infinity()) && largest != no_pair) {
    out.alpha = 0;
    return out;
  }
  const BoundTotal total = total_.get();
  out.alpha = total.time();
  out.queries = static_cast<long long>(total.queries);
  out.probes = static_cast<long long>(total.probes);
  out.capped = static_cast<long long>(total.capped);
  out.zero = static_cast<long long>(total.at_zero);
  if (total.sooner == 0) return out;
  out.kind = static_cast<ContactKind>(total.list);
  out.key = key_of(static_cast<int>(total.list), total.pair);
  return out;
}

void ExecutorStepBound::look(const ExecutorCandidates& candidates, const PositionsView& x0,
                             const PositionsView& x1) {
  start(x0, x1);
  lists_ = candidate_lists(candidates);
  in_batches(lists_.of_obstacles(), [this](Index at) {
    return AskObstacles{query_, lists_, lists_.begin[first_obstacle_list] + at};
  });
  if (lists_.begin[first_obstacle_list] > 0) look_at_chunk(0);
}

StepBound ExecutorStepBound::finish() {
  for (Index begin = 0; begin < lists_.begin[first_obstacle_list]; begin += batches_.chunk) {
    if (begin > 0) look_at_chunk(begin);
    ask_rest(begin);
  }
  return result();
}

StepBound ExecutorStepBound::find_without_list(const CandidateSource& source, const PositionsView& x0,
                                               const PositionsView& x1) {
  start(x0, x1);
  if (source.obstacles) {
    ask_all_obstacles<1>();
    ask_all_obstacles<2>();
    ask_all_obstacles<3>();
  }
  ask_tree<PairKind::point_point>(source.point_point);
  ask_tree<PairKind::point_edge>(source.point_edge);
  ask_tree<PairKind::point_triangle>(source.point_triangle);
  ask_tree<PairKind::edge_edge>(source.edge_edge);
  return result();
}

}  // namespace bb::exec
