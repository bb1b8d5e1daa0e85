// Kernels of the step bound: which pairs are proven to come later than the smallest time known, and the times of the
// others. A launch reads what was known before it and changes nothing of that, so that no counter depends on an order.
#pragma once

#include "core/contact/executor/candidate_lists.hpp"
#include "core/contact/executor/pair_search.hpp"
#include "core/contact/float_rounding.hpp"
#include "core/contact/obstacle_pair.hpp"
#include "core/contact/pair_planes.hpp"
#include "core/exec/sums/compaction_kernels.hpp"
#include "core/exec/sums/sum_kernels.hpp"
#include "core/geometry/accd.hpp"

namespace bb::exec {

constexpr Key no_pair = ~Key{0};

/// What the queries of one item counted.
struct QueryCounts {
  std::uint32_t queries = 0, probes = 0, capped = 0, zero = 0;
};

/// What is known of the bound of a motion: a sum (sum_kernels.hpp) over the items of its batches.
struct BoundTotal {
  Key sooner;      // complemented bits of the smallest time below 1; 0: there is none
  Key list, pair;  // the first that stops the motion then
  Key queries, probes, capped, at_zero;

  BB_HD static BoundTotal zero() { return {0, 0, 0, 0, 0, 0, 0}; }
  BB_HD double time() const { return sooner == 0 ? 1 : from_ordered_bits(~sooner); }
  /// The earlier one stops the motion; on a tie the first in the order of lists and pairs.
  BB_HD void meet(Key its_sooner, Key its_list, Key its_pair) {
    const bool first = its_list != list ? its_list < list : its_pair < pair;
    if (its_sooner < sooner || its_sooner == 0 || (its_sooner == sooner && !first)) return;
    sooner = its_sooner, list = its_list, pair = its_pair;
  }
  /// A time of a pair; 1: none.
  BB_HD void put(double toi, int its_list, Key its_pair) {
    if (toi < 1) meet(~ordered_bits(toi), static_cast<Key>(its_list), its_pair);
  }
  BB_HD void count(const QueryCounts& counted) {
    queries += counted.queries, probes += counted.probes;
    capped += counted.capped, at_zero += counted.zero;
  }
  friend BB_HD BoundTotal operator+(const BoundTotal& a, const BoundTotal& b) {
    BoundTotal out = a;
    out.meet(b.sooner, b.list, b.pair);
    out.queries += b.queries, out.probes += b.probes, out.capped += b.capped, out.at_zero += b.at_zero;
    return out;
  }
};

/// What every query of a motion reads.
struct BoundQuery {
  SurfaceView surface;
  const double *x0, *x1;
  double park;  // in units of d_hat
  int max_probes;
  const BoundTotal* total;  // of the batches before

  BB_HD double known() const { return total->time(); }
};

/// largest: the least complemented bits of |x[i]|; NaNs are above infinity.
struct LargestCoordinate {
  static constexpr Index a_thread = 8;
  static constexpr Index a_block = a_thread * block_threads;
  const double *x0, *x1;  // [n] each
  Index n;
  Key* largest;  // all ones before

  struct Shared {
    Key most[block_threads];
  };
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    const LargestCoordinate k = *this;
    Key* const most = shared.most;
    block.threads([=](int t) {
      most[t] = 0;
      for (Index m = 0; m < a_thread; ++m) {
        const Index i = b * a_block + m * block_threads + t;
        if (i >= 2 * k.n) break;
        const Key bits = ordered_bits(i < k.n ? k.x0[i] : k.x1[i - k.n]) << 1 >> 1;
        most[t] = bits > most[t] ? bits : most[t];
      }
    });
    fold(block, most, block_threads, [](Key x, Key y) { return y > x ? y : x; });
    block.once([=] { atomic_min(k.largest, ~most[0]); });
  }
};

/// Points of a pair relative to its first one.
template <PairKind K>
BB_HD PairLanes<K, double> relative_points(const double* x, const int* vertex) {
  PairLanes<K, double> out;
  for (int k = 0; k < pair_points(K); ++k) {
    for (int c = 0; c < 3; ++c) {
      out.x[k][c] = x[3 * static_cast<Index>(vertex[k]) + c] - x[3 * static_cast<Index>(vertex[0]) + c];
    }
  }
  return out;
}

/// No less than the least stop level of a pair of these n vertices, m, with a margin for its rounding: by their own
/// coordinates, and by `size`, the largest of its other lengths.
BB_HD inline double stop_floor(const BoundQuery& q, const int* vertex, int n, double size) {
  double largest = size;
  for (int k = 0; k < n; ++k) {
    for (int c = 0; c < 3; ++c) {
      const double a = std::abs(q.x0[3 * static_cast<Index>(vertex[k]) + c]);
      const double b = std::abs(q.x1[3 * static_cast<Index>(vertex[k]) + c]);
      largest = a > largest ? a : largest;
      largest = b > largest ? b : largest;
    }
  }
  return 2 * ulp_floor(largest);
}

/// A time before which the pair stays above its stop level, by axes and planes; no better than needed to be above
/// `enough`. 0: nothing is proven.
template <PairKind K>
BB_HD double proven_time(const BoundQuery& q, const PairVertices<K>& pair, double enough) {
  const double park = q.park * pair.law.d_hat,
               floor = stop_floor(q, pair.vertex, pair_points(K), pair.law.offset);
  const double reach = pair.law.offset + 2 * (park > floor ? park : floor);
  const PairLanes<K, double> points = relative_points<K>(q.x0, pair.vertex);
  const PairLanes<K, double> motion = relative_points<K>(q.x1, pair.vertex) - points;
  const double by_axes = proven_times_by_axes<K, double>(points, motion, reach);
  if (by_axes > enough) return by_axes;
  const double by_planes = proven_times<K, double>(points, motion, reach, enough);
  return by_planes > by_axes ? by_planes : by_axes;
}

/// The pair's own time, 1 when it is proven to be above `enough`.
template <PairKind K>
BB_HD double time_of(const BoundQuery& q, const PairVertices<K>& pair, double enough, QueryCounts& counts) {
  constexpr int N = pair_points(K);
  const AccdResult<double> r =
      accd<K, double>(points_of<N>(q.x0, pair.vertex), points_of<N>(q.x1, pair.vertex), pair.law.offset,
                      q.park * pair.law.d_hat, q.max_probes, enough);
  const double toi = r.hit ? r.toi : 1;
  counts.queries += 1;
  counts.probes += static_cast<std::uint32_t>(r.probes);
  counts.capped += r.capped ? 1 : 0;
  counts.zero += toi == 0 ? 1 : 0;
  return toi;
}

/// The time of primitive i with N vertices and obstacle o; points have a formula, and are not counted as queries. 1 when
/// it is proven to be above `enough`.
template <int N>
BB_HD double obstacle_time(const BoundQuery& q, Index i, Index o, double enough, QueryCounts& counts) {
  const PrimitiveView<N>& of = q.surface.primitives<N>();
  const int* const vertex = of.vertex + N * i;
  const AnalyticSurface<double> obstacle = q.surface.obstacles[o].surface(q.x0),
                                end = q.surface.obstacles[o].surface(q.x1);
  const Mat<double, 3, N> from = points_of<N>(q.x0, vertex), to = points_of<N>(q.x1, vertex);
  const double offset = of.offset[i], park = q.park * of.d_hat[i];
  double toi = 1;
  if constexpr (N == 1) {
    toi = obstacle_toi<double>(obstacle, end, from, to, offset, park);
  } else {
    const double floor = stop_floor(q, vertex, N, offset);
    const double stop = park > floor ? park : floor;  // the obstacle's own is added there
    if (obstacle_proven_time<N, double>(obstacle, end, from, to, offset, stop, enough) > enough) return 1;
    const AccdResult<double> r =
        obstacle_accd<N, double>(obstacle, end, from, to, offset, park, q.max_probes, enough);
    if (r.hit) toi = r.toi;
    counts.queries += 1;
    counts.probes += static_cast<std::uint32_t>(r.probes);
    counts.capped += r.capped ? 1 : 0;
  }
  counts.zero += toi == 0 ? 1 : 0;
  return toi;
}

/// A time before which a pair of any list of pairs stays above its stop level: proven_time().
BB_HD inline double proven_time_of(const BoundQuery& q, const CandidateItem& item, double enough) {
  const Index i = first_of(item.pair), j = second_of(item.pair);
  const SurfaceView& s = q.surface;
  switch (item.list) {
    case 0:
      return proven_time(q, pair_vertices<PairKind::point_point>(s, i, j), enough);
    case 1:
      return proven_time(q, pair_vertices<PairKind::point_edge>(s, i, j), enough);
    case 2:
      return proven_time(q, pair_vertices<PairKind::point_triangle>(s, i, j), enough);
    default:
      return proven_time(q, pair_vertices<PairKind::edge_edge>(s, i, j), enough);
  }
}
/// The same for time_of().
BB_HD inline double time_of_item(const BoundQuery& q, const CandidateItem& item, double enough,
                                 QueryCounts& counts) {
  const Index i = first_of(item.pair), j = second_of(item.pair);
  const SurfaceView& s = q.surface;
  switch (item.list) {
    case 0:
      return time_of(q, pair_vertices<PairKind::point_point>(s, i, j), enough, counts);
    case 1:
      return time_of(q, pair_vertices<PairKind::point_edge>(s, i, j), enough, counts);
    case 2:
      return time_of(q, pair_vertices<PairKind::point_triangle>(s, i, j), enough, counts);
    default:
      return time_of(q, pair_vertices<PairKind::edge_edge>(s, i, j), enough, counts);
  }
}

/// Counts of RankItems: 1 for the pairs of a chunk, items begin and on, that have to be queried; until when a pair is proven
/// apart, rounded down.
struct ScreenPairs {
  static constexpr bool two = false;
  BoundQuery query;
  CandidateLists lists;
  Index begin;
  float* proven;
  std::uint8_t* keep;
  BB_HD int operator()(Index i) const {
    const double known = query.known();
    const double until = proven_time_of(query, lists[begin + i], known);
    const float below = until > 0 ? float_below(until) : 0;
    proven[i] = below > 0 ? below : 0;
    return keep[i] = until > known ? 0 : 1;
  }
};

/// asked[place of i]: the time that pair i is proven, then i, so that sorting its bits puts early ones first.
struct KeepPairs {
  const float* proven;
  const std::uint8_t* keep;
  Places places;
  Key* asked;
  BB_HD void operator()(Index i) const {
    if (keep[i] == 0) return;
    std::uint32_t bits;
    memcpy(&bits, proven + i, sizeof bits);
    asked[places.of(i)] = static_cast<Key>(i) << 32 | bits;
  }
};

// --- parts of SumParts: what the items of a batch report of the bound
/// Queries the pairs of a batch that are not proven to be later than what is known. Where n_asked is there: the first batch
/// of a chunk, whose pairs are not sorted; nothing where one batch does not hold all of them.
struct AskPairs {
  using Sum = BoundTotal;
  BoundQuery query;
  CandidateLists lists;
  Index begin;       // of the chunk
  const Key* asked;  // of the batch
  const Index* n_asked;
  Index most;
  BB_HD void operator()(Index i, BoundTotal& sum) const {
    if (n_asked && (*n_asked > most || i >= *n_asked)) return;
    const std::uint32_t bits = static_cast<std::uint32_t>(asked[i]);
    float proven;
    memcpy(&proven, &bits, sizeof proven);
    const double known = query.known();
    if (static_cast<double>(proven) > known) return;
    const CandidateItem item = lists[begin + static_cast<Index>(asked[i] >> 32)];
    QueryCounts counts;
    sum.put(time_of_item(query, item, known, counts), item.list, item.pair);
    sum.count(counts);
  }
};

/// Queries all pairs of the leaves from `place` on without a list of them.
template <PairKind K>
struct AskInTree {
  using Sum = BoundTotal;
  BoundQuery query;
  PairSearch search;
  Index place;
  BB_HD void operator()(Index i, BoundTotal& sum) const {
    QueryCounts counts;
    double first = 1;
    Key which = no_pair;
    const double known = query.known();
    for_each_pair<K>(search, place + i, [&](Index a, Index b) {
      const double enough = first < known ? first : known;
      const auto pair = pair_vertices<K>(query.surface, a, b);
      if (proven_time<K>(query, pair, enough) > enough) return;
      const double toi = time_of<K>(query, pair, enough, counts);
      const Key key = pair_of(a, b);
      if (toi < first || (toi == first && key < which)) first = toi, which = key;
    });
    sum.put(first, static_cast<int>(K), which);
    sum.count(counts);
  }
};

/// Queries the candidates of obstacles from item `begin` on.
struct AskObstacles {
  using Sum = BoundTotal;
  BoundQuery query;
  CandidateLists lists;
  Index begin;
  BB_HD void operator()(Index k, BoundTotal& sum) const {
    const CandidateItem item = lists[begin + k];
    const Index i = first_of(item.pair), o = second_of(item.pair);
    const double known = query.known();
    QueryCounts counts;
    const double toi = item.list == first_obstacle_list       ? obstacle_time<1>(query, i, o, known, counts)
                       : item.list == first_obstacle_list + 1 ? obstacle_time<2>(query, i, o, known, counts)
                                                              : obstacle_time<3>(query, i, o, known, counts);
    sum.put(toi, item.list, item.pair);
    sum.count(counts);
  }
};

/// The same for all obstacles of surface primitives, without a list.
template <int N>
struct AskObstaclesOf {
  using Sum = BoundTotal;
  BoundQuery query;
  Index first_primitive;
  BB_HD void operator()(Index i, BoundTotal& sum) const {
    QueryCounts counts;
    double first = 1;
    Key which = no_pair;
    const double known = query.known();
    for (int o = 0; o < query.surface.n_obstacles; ++o) {
      if (!may_reach<N>(query.surface, first_primitive + i, o, query.x0, query.x1)) continue;
      const double enough = first < known ? first : known;
      const double toi = obstacle_time<N>(query, first_primitive + i, o, enough, counts);
      if (toi < first) first = toi, which = pair_of(first_primitive + i, o);
    }
    sum.put(first, obstacle_pairs_of<N>, which);
    sum.count(counts);
  }
};

}  // namespace bb::exec
