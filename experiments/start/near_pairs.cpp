#include "experiments/start/near_pairs.hpp"

#include "core/contact/contact_system.hpp"
#include "core/contact/row_rule.hpp"
#include "experiments/run/method.hpp"

namespace bb {
namespace {

std::vector<AnalyticSurface<double>> surfaces_of(const Scene& scene) {
  std::vector<AnalyticSurface<double>> out;
  for (const Obstacle& o : scene.obstacles) out.push_back(analytic_surface<double>(o));
  return out;
}

}  // namespace

ContactKey NearPair::key() const {
  ContactKey out{-1, -1, -1, -1};
  std::size_t n = 0;
  if (obstacle >= 0) out[n++] = id_of_obstacle(obstacle);
  for (const int v : vertex) {
    if (v >= 0 && n < out.size()) out[n++] = v;
  }
  std::sort(out.begin(), out.end());
  return out;
}

NearPairs::NearPairs(const RunConfig& config, const Scene& scene)
    : surface_(contact_surface(scene, contact_options(config.contact))),
      obstacles_(surfaces_of(scene)),
      broad_phase_(surface_, obstacles_, plan_contact(scene, contact_options(config.contact))) {}

template <PairKind K>
void NearPairs::add(const Positions& x, IndexPair index, double reach, std::vector<NearPair>& out) const {
  const ContactPair<K> pair = contact_pair<K>(surface_, index);
  const auto points = gather(x, pair.vertex);
  if (farther_than<K>(points, pair.law.offset + pair.law.d_hat + reach)) return;
  const auto closest = closest_points<K, double>(points);
  NearPair near;
  near.kind = contact_kind<K>();
  near.gap = closest.d - pair.law.offset;
  near.d_hat = activation_distance<K>(surface_, pair.vertex.data(), pair.law);
  if (!(near.gap < near.d_hat + reach)) return;
  if (closest.d > 0) near.normal = closest.r / closest.d;
  for (std::size_t k = 0; k < pair.vertex.size(); ++k) {
    near.vertex[k] = pair.vertex[k];
    near.weight[k] = closest.weights[static_cast<int>(k)];
    if (static_cast<int>(k) < pair_split(K)) near.place += near.weight[k] * points.col(static_cast<int>(k));
  }
  out.push_back(near);
}

template <int N>
void NearPairs::add_obstacle(const Primitives<N>& primitives, const Positions& x, IndexPair index,
                             double reach, std::vector<NearPair>& out) const {
  const auto i = static_cast<std::size_t>(index.first);
  const AnalyticSurface<double> obstacle = posed(obstacles_[static_cast<std::size_t>(index.second)], x);
  const auto& vertex = primitives.vertices[i];
  const Mat<double, 3, N> points = gather(x, vertex);
  NearPair near;
  near.kind = static_cast<ContactKind>(obstacle_pairs_of<N>);
  near.obstacle = index.second;
  near.d_hat = primitives.side[i].d_hat;
  if constexpr (N == 1) {
    const SurfaceGap<double> gap = surface_gap<double>(obstacle, Vec3d(points.col(0)));
    near.gap = gap.d, near.normal = gap.normal, near.weight[0] = 1;
  } else {
    const auto closest = closest_points<centre_pair<N>, double>(about_centre<N, double>(obstacle, points));
    near.gap = closest.d - obstacle.radius;
    if (closest.d > 0) near.normal = -closest.r / closest.d;
    for (int k = 0; k < N; ++k) near.weight[static_cast<std::size_t>(k)] = -closest.weights[k + 1];
  }
  near.gap -= primitives.side[i].offset;
  if (!(near.gap < near.d_hat + reach)) return;
  for (std::size_t k = 0; k < vertex.size(); ++k) {
    near.vertex[k] = vertex[k];
    near.place += near.weight[k] * points.col(static_cast<int>(k));
  }
  out.push_back(near);
}

std::vector<NearPair> NearPairs::find(const Positions& x, const Positions& x1, double reach) {
  std::vector<NearPair> out;
  if (!broad_phase_.active()) return out;
  broad_phase_.update(x, x1, candidates_);
  for_each_kind(candidates_, [&]<PairKind K>(const std::vector<IndexPair>& pairs) {
    for (const IndexPair& index : pairs) add<K>(x, index, reach, out);
  });
  for_each_obstacle_list(surface_, candidates_,
                         [&]<int N>(const Primitives<N>& primitives, const std::vector<IndexPair>& pairs) {
                           for (const IndexPair& index : pairs)
                             add_obstacle<N>(primitives, x, index, reach, out);
                         });
  return out;
}

}  // namespace bb
