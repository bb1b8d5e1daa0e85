// Kernels of the step bound: which pairs are proven to come later than the smallest time known, and the times of the
// others. A launch reads what was known before it and changes nothing of that, so that no counter depends on an order.
#pragma once

#include "core/contact/float_rounding.hpp"
#include "core/contact/obstacle_pair.hpp"
#include "core/contact/pair_planes.hpp"
#include "core/geometry/accd.hpp"
#include "core/resident/contact/compaction_kernels.hpp"
#include "core/resident/contact/pair_search.hpp"
#include "core/resident/sums/sum_kernels.hpp"

namespace bb::resident {

constexpr int n_bound_lists =
    7;  // the kinds of PairKind in their order, then obstacles with points, edges, triangles
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
  BB_HD double time() const { return sooner == 0 ? 1 : exec::from_ordered_bits(~sooner); }
  /// The earlier one stops the motion; on a tie the first in the order of lists and pairs.
  BB_HD void meet(Key its_sooner, Key its_list, Key its_pair) {
    const bool first = its_list != list ? its_list < list : its_pair < pair;
    if (its_sooner < sooner || its_sooner == 0 || (its_sooner == sooner && !first)) return;
    sooner = its_sooner, list = its_list, pair = its_pair;
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

/// largest: the least complemented bits of |x[i]|; no numbers are above infinity.
struct LargestCoordinate {
  static constexpr Index a_thread = 8;
  static constexpr Index a_block = a_thread * exec::block_threads;
  const double* x;
  Index n;
  Key* largest;  // all ones before

  struct Shared {
    Key most[exec::block_threads];
  };
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    const LargestCoordinate k = *this;
    Key* const most = shared.most;
    block.threads([=](int t) {
      most[t] = 0;
      for (Index m = 0; m < a_thread; ++m) {
        const Index i = b * a_block + m * exec::block_threads + t;
        if (i >= k.n) break;
        const Key bits = exec::ordered_bits(k.x[i]) << 1 >> 1;
        most[t] = bits > most[t] ? bits : most[t];
      }
    });
    for (int half = exec::block_threads / 2; half > 0; half /= 2) {
      block.threads([=](int t) {
        if (t < half) most[t] = most[t + half] > most[t] ? most[t + half] : most[t];
      });
    }
    block.threads([=](int t) {
      if (t == 0) exec::atomic_min(k.largest, ~most[0]);
    });
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

/// No less than the least stop level of a pair of these n vertices, m, with room for its rounding: by their own
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
  const AnalyticSurface<double> obstacle = q.surface.obstacles[o].surface();
  const Mat<double, 3, N> from = points_of<N>(q.x0, vertex), to = points_of<N>(q.x1, vertex);
  const double offset = of.offset[i], park = q.park * of.d_hat[i];
  double toi = 1;
  if constexpr (N == 1) {
    toi = obstacle_toi<double>(obstacle, obstacle, from, to, offset, park);
  } else {
    const double floor = stop_floor(q, vertex, N, offset);
    const double stop = park > floor ? park : floor;  // the obstacle's own is added there
    if (obstacle_proven_time<N, double>(obstacle, obstacle, from, to, offset, stop, enough) > enough)
      return 1;
    const AccdResult<double> r =
        obstacle_accd<N, double>(obstacle, obstacle, from, to, offset, park, q.max_probes, enough);
    if (r.hit) toi = r.toi;
    counts.queries += 1;
    counts.probes += static_cast<std::uint32_t>(r.probes);
    counts.capped += r.capped ? 1 : 0;
  }
  counts.zero += toi == 0 ? 1 : 0;
  return toi;
}

/// The earliest time of each item of a batch, its pair, and what it counted.
struct BatchTimes {
  Key *time, *pair;
  QueryCounts* counts;
  BB_HD void put(Index i, double toi, Key which, const QueryCounts& counted) const {
    time[i] = exec::ordered_bits(toi);
    pair[i] = which;
    counts[i] = counted;
  }
};

/// Parts of SumParts: what the items of a batch say.
struct BatchParts {
  using Sum = BoundTotal;
  BatchTimes of;
  Key list;
  BB_HD void operator()(Index i, BoundTotal& sum) const {
    if (of.time[i] < exec::ordered_bits(1.0) && of.pair[i] != no_pair)
      sum.meet(~of.time[i], list, of.pair[i]);
    const QueryCounts counted = of.counts[i];
    sum.queries += counted.queries, sum.probes += counted.probes;
    sum.capped += counted.capped, sum.at_zero += counted.zero;
  }
};

/// Pair i of a chunk: until when it is proven apart, rounded down, and whether it has to be asked.
template <PairKind K>
struct ScreenPairs {
  BoundQuery query;
  const Key* candidate;
  float* proven;
  std::uint8_t* keep;
  BB_HD void operator()(Index i) const {
    const double known = query.known();
    const auto pair = pair_vertices<K>(query.surface, first_of(candidate[i]), second_of(candidate[i]));
    const double until = proven_time<K>(query, pair, known);
    keep[i] = until > known ? 0 : 1;
    const float below = until > 0 ? float_below(until) : 0;
    proven[i] = below > 0 ? below : 0;
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

/// Asks the pairs of a batch that are not proven to be later than what is known.
template <PairKind K>
struct AskPairs {
  BoundQuery query;
  const Key *candidate, *asked;
  BatchTimes out;
  BB_HD void operator()(Index i) const {
    const std::uint32_t bits = static_cast<std::uint32_t>(asked[i]);
    float proven;
    memcpy(&proven, &bits, sizeof proven);
    const Key which = candidate[asked[i] >> 32];
    const double known = query.known();
    QueryCounts counts;
    double toi = 1;
    if (!(static_cast<double>(proven) > known)) {
      const auto pair = pair_vertices<K>(query.surface, first_of(which), second_of(which));
      toi = time_of<K>(query, pair, known, counts);
    }
    out.put(i, toi, which, counts);
  }
};

/// Asks all pairs of the leaves from `place` on without a list of them.
template <PairKind K>
struct AskInTree {
  BoundQuery query;
  PairSearch search;
  Index place;
  BatchTimes out;
  BB_HD void operator()(Index i) const {
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
    out.put(i, first, which, counts);
  }
};

/// Times of the candidates of primitives with N vertices and obstacles.
template <int N>
struct AskObstacles {
  BoundQuery query;
  const Key* candidate;
  BatchTimes out;
  BB_HD void operator()(Index i) const {
    QueryCounts counts;
    const double toi =
        obstacle_time<N>(query, first_of(candidate[i]), second_of(candidate[i]), query.known(), counts);
    out.put(i, toi, candidate[i], counts);
  }
};

/// The same for all obstacles of surface primitives, without a list.
template <int N>
struct AskObstaclesOf {
  BoundQuery query;
  Index first_primitive;
  BatchTimes out;
  BB_HD void operator()(Index i) const {
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
    out.put(i, first, which, counts);
  }
};

}  // namespace bb::resident
