#include "core/resident/contact/resident_step_bound.hpp"
#include "core/contact/contact_key.hpp"

#include <algorithm>
#include <limits>

namespace bb::resident {

ResidentStepBound::ResidentStepBound(exec::Executor& executor, const ResidentSurface& surface,
                                     const StopLevel& level, const BoundBatches& batches)
    : executor_(executor),
      surface_(surface),
      level_(level),
      batches_(batches),
      total_(executor),
      numbers_(executor, "step bound", 1),
      proven_(executor, "proven times"),
      places_(executor, "asked pairs"),
      asked_(executor, "asked pairs"),
      time_(executor, "times of asked pairs"),
      pair_(executor, "pairs of those times"),
      counts_(executor, "counts of those times") {}

void ResidentStepBound::start(const Column& x0, const Column& x1) {
  Key* const largest = &numbers_.data()->largest;
  executor_.fill_bytes(largest, 0xff, sizeof(Key));
  for (const Column* x : {&x0, &x1}) {
    const Index n_blocks = (x->size() + LargestCoordinate::a_block - 1) / LargestCoordinate::a_block;
    executor_.blocks(n_blocks, LargestCoordinate{x->data(), x->size(), largest});
  }
  total_.clear();
  query_ = {surface_.view(), x0.data(), x1.data(), level_.park, level_.max_probes, total_.data()};
}

/// ask(begin, n, times) for batches of [0, n), one after another.
template <class Ask>
void ResidentStepBound::in_batches(Index n, int list, const Ask& ask) {
  const Index most = std::min(n, batches_.most_asked);
  if (time_.size() < most) time_.fit(most), pair_.fit(most), counts_.fit(most);
  const BatchTimes times{time_.data(), pair_.data(), counts_.data()};
  Index length = batches_.first_asked;
  for (Index begin = 0; begin < n; begin += length) {
    if (begin > 0) length = std::min(2 * length, batches_.most_asked);
    const Index m = std::min(length, n - begin);
    ask(begin, m, times);
    total_.add(m, BatchParts{times, static_cast<Key>(list)});
  }
}

/// Those of n pairs that have to be asked, early ones first, into asked_. Returns how many.
template <PairKind K>
Index ResidentStepBound::screen(const Key* candidates, Index n) {
  if (proven_.size() < n) proven_.fit(n);
  std::uint8_t* const keep = places_.counts(n);
  executor_.each(n, ScreenPairs<K>{query_, candidates, proven_.data(), keep});
  const Index m = places_.rank(n);
  if (asked_.size() < m) asked_.fit(m);
  executor_.each(n, KeepPairs{proven_.data(), keep, places_.places(), asked_.data()});
  executor_.sort(asked_.data(), nullptr, m, 32);
  return m;
}

template <PairKind K>
void ResidentStepBound::ask_list(const exec::Buffer<Key>& candidates) {
  for (Index begin = 0; begin < candidates.size(); begin += batches_.chunk) {
    const Key* const chunk = candidates.data() + begin;
    const Index m = screen<K>(chunk, std::min(batches_.chunk, candidates.size() - begin));
    in_batches(m, static_cast<int>(K), [&](Index at, Index n, const BatchTimes& times) {
      executor_.each(n, AskPairs<K>{query_, chunk, asked_.data() + at, times});
    });
  }
}

template <PairKind K>
void ResidentStepBound::ask_tree(const PairSearch& search) {
  const Index n = search.first.top < 0 || search.second.top < 0 ? 0 : search.first.size(0);
  in_batches(n, static_cast<int>(K), [&](Index at, Index m, const BatchTimes& times) {
    executor_.each(m, AskInTree<K>{query_, search, at, times});
  });
}

template <int N>
void ResidentStepBound::ask_obstacle_list(const exec::Buffer<Key>& candidates) {
  const Key* const list = candidates.data();
  in_batches(candidates.size(), obstacle_pairs_of<N>, [&](Index at, Index n, const BatchTimes& times) {
    executor_.each(n, AskObstacles<N>{query_, list + at, times});
  });
}

template <int N>
void ResidentStepBound::ask_all_obstacles() {
  const Index n_primitives = surface_.view().primitives<N>().n;
  in_batches(n_primitives, obstacle_pairs_of<N>, [&](Index at, Index n, const BatchTimes& times) {
    executor_.each(n, AskObstaclesOf<N>{query_, at, times});
  });
}

/// Vertices of a pair, as StepBoundFinder names it.
ContactKey ResidentStepBound::key_of(int list, Key pair) const {
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
StepBound ResidentStepBound::result() {
  StepBound out;
  if (executor_.counts_only()) return out;
  executor_.copy(&numbers_.data()->total, total_.data(), sizeof(BoundTotal));
  const Numbers numbers = numbers_.get(0);
  if (~numbers.largest >= exec::ordered_bits(std::numeric_limits<double>::infinity()) &&
      numbers.largest != no_pair) {
    out.alpha = 0;
    return out;
  }
  const BoundTotal& total = numbers.total;
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

StepBound ResidentStepBound::find(const ResidentCandidates& candidates, const Column& x0, const Column& x1) {
  start(x0, x1);
  ask_obstacle_list<1>(candidates.obstacle);
  ask_obstacle_list<2>(candidates.obstacle_edge);
  ask_obstacle_list<3>(candidates.obstacle_triangle);
  ask_list<PairKind::point_point>(candidates.point_point);
  ask_list<PairKind::point_edge>(candidates.point_edge);
  ask_list<PairKind::point_triangle>(candidates.point_triangle);
  ask_list<PairKind::edge_edge>(candidates.edge_edge);
  return result();
}

StepBound ResidentStepBound::find_without_list(const CandidateSource& source, const Column& x0,
                                               const Column& x1) {
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

}  // namespace bb::resident
