#include "core/contact/step_bound.hpp"
#include "core/contact/pair_row.hpp"

#include <algorithm>

#include "core/contact/chunks.hpp"
#include "core/contact/obstacle_pair.hpp"
#include "core/contact/pair_lanes.hpp"
#include "core/geometry/accd.hpp"

namespace bb {
namespace {

/// Pairs are queried in the order of these intervals of their proven time, and not at all beyond the bound.
constexpr float intervals[] = {-1, 0, 0x1p-12f, 0x1p-6f, 0x1p-3f, 1};
/// Chunks of a batch: the first ones are short, since they know little; all are fixed, so that no counter
/// depends on threads.
constexpr std::size_t first_batch = 8, largest_batch = 1024;
static_assert(chunk_size <= std::size_t{1} << 16, "places in a chunk are 16 bits");

}  // namespace

void StepBoundFinder::take(const Part& part) {
  if (part.first.before(all_.first)) all_.first = part.first;
  all_.queries += part.queries;
  all_.probes += part.probes;
  all_.capped += part.capped;
  all_.zero += part.zero;
}

/// Twice the least stop level that each vertex requires of its pairs, by its own coordinates, in the scalar of the queries.
void StepBoundFinder::find_floors(const Motion& motion) {
  floors_.resize(static_cast<std::size_t>(motion.x0.cols()));
  with_value_scalar(precision_, [&]<class T>() {
    for_each_chunk(floors_.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const int v = static_cast<int>(i);
        const double largest =
            std::max(motion.x0.col(v).lpNorm<Eigen::Infinity>(), motion.x1.col(v).lpNorm<Eigen::Infinity>());
        floors_[i] = 2 * static_cast<double>(ulp_floor(static_cast<T>(largest)));
      }
    });
    double offset = 0;
    for (const Side& side : surface_.points.side) offset = std::max(offset, side.offset);
    largest_floor_ = 2 * static_cast<double>(ulp_floor(static_cast<T>(2 * offset)));
  });
  for (const double of_vertex : floors_) largest_floor_ = std::max(largest_floor_, of_vertex);
}

/// No less than the least stop level of a pair of these vertices, m, with a margin for its rounding; 0 where twice the
/// largest of all is no more than `park`.
template <std::size_t N>
double StepBoundFinder::floor(const std::array<int, N>& vertices, double offset, double park) const {
  if (park >= 2 * largest_floor_) return 0;
  double out = with_value_scalar(precision_,
                                 [&]<class T>() -> double { return 2 * ulp_floor(static_cast<T>(offset)); });
  for (const int v : vertices) out = std::max(out, floors_[static_cast<std::size_t>(v)]);
  return out;
}

template <int N>
void StepBoundFinder::fit(std::vector<MotionBox>& boxes, const Primitives<N>& primitives,
                          const Motion& motion) const {
  boxes.resize(primitives.size());
  for_each_chunk(primitives.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      // two of these are no less than the distance that ask_lanes needs, whichever side has the larger floor
      const Side side = primitives.side[i];
      const double park = level_.park * side.d_hat;
      const double reach = side.offset + std::max(park, 2 * floor(primitives.vertices[i], side.offset, park));
      boxes[i] = motion_box(primitives.vertices[i], reach, motion.x0, motion.x1);
    }
  });
}

template <PairKind K>
void StepBoundFinder::screen(const std::vector<IndexPair>& pairs) {
  const std::vector<MotionBox>& first = K == PairKind::edge_edge ? edges_ : points_;
  const std::vector<MotionBox>& second = K == PairKind::point_point      ? points_
                                         : K == PairKind::point_triangle ? triangles_
                                                                         : edges_;
  std::vector<Entry>& entries = entries_[static_cast<int>(K)];
  std::vector<std::uint32_t>& counts = n_entries_[static_cast<int>(K)];
  if (entries.size() < pairs.size()) entries.resize(pairs.size());
  counts.assign(n_chunks(pairs.size()), 0);
  const float bound = float_above(all_.first.toi);
  for_each_chunk(pairs.size(), [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    Entry* next = entries.data() + begin;
    for (std::size_t i = begin; i < end; ++i) {
      const float proven = proven_time(first[static_cast<std::size_t>(pairs[i].first)],
                                       second[static_cast<std::size_t>(pairs[i].second)]);
      *next = {static_cast<std::uint16_t>(i - begin), proven};
      next += proven > bound ? 0 : 1;  // hard to foretell: no branch
    }
    counts[chunk] = static_cast<std::uint32_t>(next - (entries.data() + begin));
  });
}

template <PairKind K>
void StepBoundFinder::ask_lanes(const std::vector<IndexPair>& pairs, const Motion& motion,
                                const std::array<std::size_t, 4>& index, std::size_t n, Part& part) const {
  const auto pair = four_pairs<K>(surface_, pairs, n, [&](std::size_t lane) { return index[lane]; });
  Lanes4 reach;
  for (std::size_t lane = 0; lane < n_lanes; ++lane) {
    const Side law = pair[lane].law;
    const double park = level_.park * law.d_hat;
    reach.v[lane] = law.offset + 2 * std::max(park, floor(pair[lane].vertex, law.offset, park));
  }
  const PairLanes<K, Lanes4> points = gather_lanes<K>(pair, motion.x0);
  const Lanes4 proven =
      proven_times<K, Lanes4>(points, gather_lanes<K>(pair, motion.x1) - points, reach, part.first.toi);
  for (std::size_t lane = 0; lane < n; ++lane) {
    if (proven[static_cast<int>(lane)] > part.first.toi) continue;
    with_value_scalar(precision_, [&]<class T>() { ask<K, T>(pair[lane], index[lane], motion, part); });
  }
}

/// The pair's own time, in the scalar T.
template <PairKind K, class T>
void StepBoundFinder::ask(const ContactPair<K>& pair, std::size_t index, const Motion& motion,
                          Part& part) const {
  const T park = static_cast<T>(level_.park * pair.law.d_hat), enough = static_cast<T>(part.first.toi);
  const AccdResult<T> r =
      accd<K, T>(gather_in<T>(motion.x0, pair.vertex), gather_in<T>(motion.x1, pair.vertex),
                 static_cast<T>(pair.law.offset), park, level_.max_probes, enough);
  const FirstContact found{r.hit ? r.toi : 1, static_cast<int>(K), index};
  if (found.before(part.first)) part.first = found;
  ++part.queries;
  part.probes += r.probes;
  part.capped += r.capped;
  part.zero += found.toi == 0;
}

template <PairKind K>
void StepBoundFinder::ask_chunk(const std::vector<IndexPair>& pairs, const Motion& motion, float above,
                                float up_to, std::size_t chunk, Part& part) const {
  const Entry* const entries = entries_[static_cast<int>(K)].data() + chunk * chunk_size;
  std::array<std::size_t, 4> index{};
  std::size_t n = 0;
  for (std::size_t k = 0; k < n_entries_[static_cast<int>(K)][chunk]; ++k) {
    const Entry entry = entries[k];
    if (!(entry.proven > above) || entry.proven > up_to || entry.proven > part.first.toi) continue;
    index[n++] = chunk * chunk_size + entry.place;
    if (n < n_lanes) continue;
    ask_lanes<K>(pairs, motion, index, n, part);
    n = 0;
  }
  if (n > 0) ask_lanes<K>(pairs, motion, index, n, part);
}

template <PairKind K>
void StepBoundFinder::ask_batches(const std::vector<IndexPair>& pairs, const Motion& motion, float above,
                                  float up_to) {
  std::size_t length = first_batch;
  for (std::size_t begin = 0; begin < n_chunks(pairs.size()); begin += length) {
    if (begin > 0) length = std::min(2 * length, largest_batch);
    const std::size_t n = std::min(length, n_chunks(pairs.size()) - begin);
    parts_.assign(n, Part{all_.first});
    parallel_items(n, 1,
                   [&](std::size_t k) { ask_chunk<K>(pairs, motion, above, up_to, begin + k, parts_[k]); });
    for (const Part& part : parts_) take(part);
  }
}

/// The time of a pair of an obstacle; vertices have a formula, and are not counted as queries.
template <int N, class T>
FirstContact StepBoundFinder::ask_obstacle(const Primitives<N>& primitives, IndexPair pair, std::size_t index,
                                           const Motion& motion, Part& part) const {
  const std::size_t i = static_cast<std::size_t>(pair.first);
  const auto& vertex = primitives.vertices[i];
  const Side law = primitives.side[i];
  const AnalyticSurface<double>& given = obstacles_[static_cast<std::size_t>(pair.second)];
  const AnalyticSurface<double> exact = posed(given, motion.x0), exact_end = posed(given, motion.x1);
  const AnalyticSurface<T> obstacle = surface_in<T>(exact), end = surface_in<T>(exact_end);
  const T offset = static_cast<T>(law.offset), park = static_cast<T>(level_.park * law.d_hat);
  FirstContact found{1, obstacle_pairs_of<N>, index};
  if constexpr (N == 1) {
    found.toi = obstacle_toi(obstacle, end, gather_in<T>(motion.x0, vertex), gather_in<T>(motion.x1, vertex),
                             offset, park);
  } else {
    const double level = level_.park * law.d_hat;
    const double stop =
        std::max(level, floor(vertex, law.offset, level));  // the obstacle's own is added there
    const double proven =
        obstacle_proven_time<N, T>(exact, exact_end, gather(motion.x0, vertex), gather(motion.x1, vertex),
                                   law.offset, stop, part.first.toi);
    if (proven > part.first.toi) return found;
    const AccdResult<T> r =
        obstacle_accd<N, T>(obstacle, end, gather_in<T>(motion.x0, vertex), gather_in<T>(motion.x1, vertex),
                            offset, park, level_.max_probes, static_cast<T>(part.first.toi));
    if (r.hit) found.toi = r.toi;
    ++part.queries;
    part.probes += r.probes;
    part.capped += r.capped;
  }
  part.zero += found.toi == 0 ? 1 : 0;
  return found;
}

template <int N, class T>
void StepBoundFinder::ask_obstacles(const Primitives<N>& primitives, const std::vector<IndexPair>& pairs,
                                    const Motion& motion) {
  parts_.assign(n_chunks(pairs.size()), Part{all_.first});
  for_each_chunk(pairs.size(), [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    Part& part = parts_[chunk];
    for (std::size_t i = begin; i < end; ++i) {
      const FirstContact found = ask_obstacle<N, T>(primitives, pairs[i], i, motion, part);
      if (found.before(part.first)) part.first = found;
    }
  });
  for (const Part& part : parts_) take(part);
}

/// The bound with the name of the pair that limits.
StepBound StepBoundFinder::result(const Candidates& candidates) const {
  StepBound out;
  out.queries = all_.queries;
  out.probes = all_.probes;
  out.capped = all_.capped;
  out.zero = all_.zero;
  out.alpha = all_.first.toi;
  if (out.alpha == 1) return out;
  int list = 0;
  for_each_kind(candidates, [&]<PairKind K>(const std::vector<IndexPair>& pairs) {
    if (list++ != all_.first.list) return;
    out.kind = contact_kind<K>();
    out.key = pair_key(contact_pair<K>(surface_, pairs[all_.first.index]).vertex);
  });
  for_each_obstacle_list(
      surface_, candidates, [&]<int N>(const Primitives<N>& primitives, const std::vector<IndexPair>& pairs) {
        if (obstacle_pairs_of<N> != all_.first.list) return;
        const IndexPair pair = pairs[all_.first.index];
        out.kind = static_cast<ContactKind>(obstacle_pairs_of<N>);
        out.key = obstacle_key(pair.second, primitives.vertices[static_cast<std::size_t>(pair.first)]);
      });
  return out;
}

StepBound StepBoundFinder::find(const Candidates& candidates, const PositionsView& x0,
                                const PositionsView& x1) {
  if (!x0.allFinite() || !x1.allFinite()) {  // boxes and planes below would lose NaN and infinite coordinates
    StepBound none;
    none.alpha = 0;
    return none;
  }
  const Motion motion{x0, x1};
  find_floors(motion);
  all_ = {};
  with_value_scalar(precision_, [&]<class T>() {
    for_each_obstacle_list(surface_, candidates,
                           [&]<int N>(const Primitives<N>& primitives, const std::vector<IndexPair>& pairs) {
                             ask_obstacles<N, T>(primitives, pairs, motion);
                           });
  });
  if (!candidates.point_triangle.empty() || !candidates.point_edge.empty() || !candidates.point_point.empty())
    fit(points_, surface_.points, motion);
  if (!candidates.edge_edge.empty() || !candidates.point_edge.empty()) fit(edges_, surface_.edges, motion);
  if (!candidates.point_triangle.empty()) fit(triangles_, surface_.triangles, motion);
  for_each_kind(candidates, [&]<PairKind K>(const std::vector<IndexPair>& pairs) { screen<K>(pairs); });
  for (std::size_t k = 0; k + 1 < std::size(intervals) && !(intervals[k] > all_.first.toi); ++k) {
    for_each_kind(candidates, [&]<PairKind K>(const std::vector<IndexPair>& pairs) {
      ask_batches<K>(pairs, motion, intervals[k], intervals[k + 1]);
    });
  }
  return result(candidates);
}

}  // namespace bb
