#include "core/contact/motion_pairs.hpp"

#include <algorithm>
#include <limits>

#include "core/contact/chunks.hpp"
#include "core/contact/obstacle_pair.hpp"
#include "core/contact/pair_geometry.hpp"
#include "core/contact/row_rule.hpp"
#include "core/geometry/accd.hpp"

namespace bb {
namespace {

std::vector<AnalyticSurface<double>> posed_surfaces(const Scene& scene) {
  std::vector<AnalyticSurface<double>> out;
  for (const Obstacle& o : scene.obstacles) out.push_back(analytic_surface<double>(o));
  return out;
}

LinearGap linear_gap(const Surface& surface, const PairRow& row, double d_hat) {
  LinearGap out;
  out.normal = row.normal;
  out.d = row.d;
  out.d_hat = d_hat;
  std::size_t n = 0;
  for (int k = 0; k < 4; ++k) {
    if (row.stencil[k] < 0 || !surface.is_free(row.stencil[k])) continue;
    out.vertex[n] = row.stencil[k];
    out.weight[n++] = row.weight[k];
  }
  return out;
}

template <PairKind K>
LinearGap surface_gap_of(const Surface& surface, IndexPair index, const PositionsView& x) {
  const ContactPair<K> pair = contact_pair<K>(surface, index);
  const auto closest = closest_points<K, double>(gather(x, pair.vertex));
  const PairRow row = pair_row<double>(pair.vertex.data(), closest.weights.data(), closest.r, closest.d,
                                       closest.region, pair.law.offset);
  return linear_gap(surface, row, activation_distance<K>(surface, pair.vertex.data(), pair.law));
}

template <int N>
LinearGap obstacle_gap_of(const Surface& surface, const Primitives<N>& primitives, int place,
                          const AnalyticSurface<double>& obstacle, const PositionsView& x) {
  const auto& vertex = primitives.vertices[static_cast<std::size_t>(place)];
  const Side law = primitives.side[static_cast<std::size_t>(place)];
  FoundRow row;
  const Side far{std::numeric_limits<double>::infinity(), law.offset};  // a row at any distance
  obstacle_pair_row<N, double>(surface, vertex.data(), far, obstacle, gather(x, vertex), false, row);
  return linear_gap(surface, row, law.d_hat);
}

template <std::size_t N>
MotionHit hit_of(PairId pair, const std::array<int, N>& vertex, double time) {
  MotionHit out;
  out.pair = pair;
  std::copy(vertex.begin(), vertex.end(), out.vertex.begin());
  out.time = time;
  return out;
}

PairId id_of(int list, IndexPair pair) {
  return bb::pair_id(list, static_cast<PairId>(pair.first), static_cast<PairId>(pair.second));
}

}  // namespace

MotionPairs::MotionPairs(const Scene& scene, const ContactOptions& options, const ContactPlan& plan)
    : options_(options),
      surface_(contact_surface(scene, options)),
      obstacles_(posed_surfaces(scene)),
      broad_phase_(surface_, obstacles_, plan) {}

LinearGap MotionPairs::gap(PairId pair, const PositionsView& x) const {
  const IndexPair index{pair_first(pair), pair_second(pair)};
  if (const int o = pair_obstacle(pair); o >= 0) {
    const AnalyticSurface<double>& obstacle = obstacles_[static_cast<std::size_t>(o)];
    const int list = pair_list(pair), place = pair_first(pair);
    if (list == obstacle_pairs_of<1>)
      return obstacle_gap_of<1>(surface_, surface_.points, place, obstacle, x);
    if (list == obstacle_pairs_of<2>) return obstacle_gap_of<2>(surface_, surface_.edges, place, obstacle, x);
    return obstacle_gap_of<3>(surface_, surface_.triangles, place, obstacle, x);
  }
  switch (static_cast<PairKind>(pair_list(pair))) {
    case PairKind::point_point:
      return surface_gap_of<PairKind::point_point>(surface_, index, x);
    case PairKind::point_edge:
      return surface_gap_of<PairKind::point_edge>(surface_, index, x);
    case PairKind::point_triangle:
      return surface_gap_of<PairKind::point_triangle>(surface_, index, x);
    case PairKind::edge_edge:
      break;
  }
  return surface_gap_of<PairKind::edge_edge>(surface_, index, x);
}

template <PairKind K>
void MotionPairs::ask(IndexPair index, const PositionsView& x0, const PositionsView& x1, Part& part) const {
  const ContactPair<K> pair = contact_pair<K>(surface_, index);
  const Mat<double, 3, pair_points(K)> from = gather(x0, pair.vertex), to = gather(x1, pair.vertex);
  const double park = options_.min_gap_fraction * pair.law.d_hat;
  const double size = std::max(from.cwiseAbs().maxCoeff(), to.cwiseAbs().maxCoeff());
  if (pair_box_distance<K>(from, to) > pair.law.offset + 2 * park + 1e-12 * size) return;
  const AccdResult<double> found = accd<K, double>(from, to, pair.law.offset, park, options_.ccd_max_probes);
  ++part.counted.queries;
  part.counted.probes += found.probes;
  part.counted.capped += found.capped;
  if (!found.hit || found.toi >= 1) return;
  part.counted.zero += found.toi == 0;
  part.hits.push_back(hit_of(id_of(static_cast<int>(K), index), pair.vertex, found.toi));
}

template <int N>
void MotionPairs::ask_obstacle(const Primitives<N>& primitives, IndexPair index, const PositionsView& x0,
                               const PositionsView& x1, Part& part) const {
  const auto& vertex = primitives.vertices[static_cast<std::size_t>(index.first)];
  const Side law = primitives.side[static_cast<std::size_t>(index.first)];
  const AnalyticSurface<double>& obstacle = obstacles_[static_cast<std::size_t>(index.second)];
  const double park = options_.min_gap_fraction * law.d_hat;
  double time = 1;
  if constexpr (N == 1) {
    time = obstacle_toi<double>(obstacle, obstacle, gather(x0, vertex), gather(x1, vertex), law.offset, park);
  } else {
    const AccdResult<double> found =
        obstacle_accd<N, double>(obstacle, obstacle, gather(x0, vertex), gather(x1, vertex), law.offset, park,
                                 options_.ccd_max_probes, 1.0);
    if (found.hit) time = found.toi;
    ++part.counted.queries;
    part.counted.probes += found.probes;
    part.counted.capped += found.capped;
  }
  if (time >= 1) return;
  part.counted.zero += time == 0;
  part.hits.push_back(hit_of(id_of(obstacle_pairs_of<N>, index), vertex, time));
}

void MotionPairs::take(const std::vector<Part>& parts) {
  for (const Part& part : parts) {
    hits_.insert(hits_.end(), part.hits.begin(), part.hits.end());
    earliest_.queries += part.counted.queries;
    earliest_.probes += part.counted.probes;
    earliest_.capped += part.counted.capped;
    earliest_.zero += part.counted.zero;
  }
}

const std::vector<MotionHit>& MotionPairs::hits(const PositionsView& x0, const PositionsView& x1) {
  hits_.clear();
  earliest_ = {};
  if (!broad_phase_.active()) return hits_;
  broad_phase_.update(x0, x1, candidates_);
  const auto over = [this](const std::vector<IndexPair>& pairs, const auto& ask_one) {
    std::vector<Part> parts(n_chunks(pairs.size()));
    for_each_chunk(pairs.size(), [&](std::size_t k, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) ask_one(pairs[i], parts[k]);
    });
    take(parts);
  };
  for_each_kind(candidates_, [&]<PairKind K>(const std::vector<IndexPair>& pairs) {
    over(pairs, [&](IndexPair pair, Part& part) { ask<K>(pair, x0, x1, part); });
  });
  for_each_obstacle_list(
      surface_, candidates_, [&]<int N>(const Primitives<N>& of, const std::vector<IndexPair>& pairs) {
        over(pairs, [&](IndexPair pair, Part& part) { ask_obstacle<N>(of, pair, x0, x1, part); });
      });
  for (const MotionHit& hit : hits_) {
    if (hit.time >= earliest_.alpha) continue;
    earliest_.alpha = hit.time;
    earliest_.kind = static_cast<ContactKind>(pair_list(hit.pair));
    earliest_.key = row_key(hit.pair, hit.vertex);
  }
  return hits_;
}

}  // namespace bb
