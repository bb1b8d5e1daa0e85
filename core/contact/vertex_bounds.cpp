#include "core/contact/vertex_bounds.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "core/contact/chunks.hpp"
#include "core/contact/obstacle_pair.hpp"
#include "core/contact/pair_geometry.hpp"

namespace bb {
namespace {

/// Part of a way `towards` (m) that uses up `room` (m); a NaN goes nowhere.
double part_of(double room, double towards) {
  if (!(towards > 0)) return towards <= 0 ? 1 : 0;
  if (!(room > 0)) return 0;
  return room < towards ? room / towards : 1;
}

}  // namespace

void VertexBounds::keep_smaller(int vertex, double part) {
  if (part >= 1) return;
  std::atomic_ref<double> kept(parts_[static_cast<std::size_t>(vertex)]);
  double known = kept.load(std::memory_order_relaxed);
  while (part < known && !kept.compare_exchange_weak(known, part, std::memory_order_relaxed)) {
  }
}

double VertexBounds::floor_of(double largest) const {
  return with_value_scalar(precision_,
                           [&]<class T>() -> double { return ulp_floor(static_cast<T>(largest)); });
}

/// As the vertices that carry the closest points approach; in halves where none does.
template <int N>
double VertexBounds::published_share(int split, const SideOf (&of)[N]) {
  double approach[2] = {0, 0};
  for (int k = 0; k < N; ++k) {
    double& fastest = approach[k < split ? 0 : 1];
    if (of[k].carries) fastest = std::max(fastest, of[k].towards);
  }
  const double both = approach[0] + approach[1];
  return both > 0 ? approach[0] / both : 0.5;
}

/// So that the vertex with the smallest part has the largest there can be. Two sides go the part t of their motion as long
/// as t (u + v) is within room + (what u has behind it) + (what v has), for all ways u of one side and v of the other; a
/// side that goes nowhere is a way of 0.
template <int N>
double VertexBounds::balanced_share(int split, const SideOf (&of)[N], double room) {
  double part = std::numeric_limits<double>::infinity();
  for (int i = -1; i < split; ++i) {
    for (int j = split - 1; j < N; ++j) {
      const SideOf first = i < 0 ? SideOf() : of[i], second = j < split ? SideOf() : of[j];
      const double way = std::max(first.towards, 0.0) + std::max(second.towards, 0.0);
      if (way > 0) part = std::min(part, (room + first.behind + second.behind) / way);
    }
  }
  if (!std::isfinite(part)) return 0.5;
  double needed = 0;  // m, of the room by the first side
  for (int i = 0; i < split; ++i) needed = std::max(needed, part * of[i].towards - of[i].behind);
  return std::min(1.0, needed / room);
}

/// Vertices of the first side, below `split`, come down from their height (m) above the others by `towards`; those of the
/// second rise by it. The plane divides the room (m) between the two sides.
template <int N>
void VertexBounds::divide(const std::array<int, N>& vertex, int split, SideOf (&of)[N], double keep) {
  double edge[2] = {of[0].height, of[split].height};
  for (int k = 0; k < N; ++k) {
    edge[k < split ? 0 : 1] = k < split ? std::min(edge[0], of[k].height) : std::max(edge[1], of[k].height);
  }
  for (int k = 0; k < N; ++k) of[k].behind = k < split ? of[k].height - edge[0] : edge[1] - of[k].height;
  const double room = edge[0] - edge[1] - keep;
  const bool balanced = rule_ == StepBoundRule::planar_balanced && room > 0;
  const double share = balanced ? balanced_share(split, of, room) : published_share(split, of);
  for (int k = 0; k < N; ++k) {
    const double own = room > 0 ? of[k].behind + room * (k < split ? share : 1 - share) : 0;
    keep_smaller(vertex[static_cast<std::size_t>(k)], part_of(gamma_ * own, of[k].towards));
  }
}

template <PairKind K>
void VertexBounds::bound_pair(const ContactPair<K>& pair, const Motion& motion) {
  constexpr int N = pair_points(K), split = pair_split(K);
  const Mat<double, 3, N> x = gather(motion.x0, pair.vertex), dx = gather(motion.x1, pair.vertex) - x;
  const double floor = floor_of(std::max(x.cwiseAbs().maxCoeff(), (x + dx).cwiseAbs().maxCoeff()));
  if (rule_ == StepBoundRule::per_vertex) {
    // a pair whose points go less than its boxes are apart bounds none of them
    const double longest = std::sqrt(dx.colwise().squaredNorm().maxCoeff());
    if (2 * longest < gamma_ * (pair_box_distance<K>(x) - pair.law.offset - floor)) return;
    const double room = gamma_ / 2 * (closest_points<K, double>(x).d - pair.law.offset - floor);
    for (int k = 0; k < N; ++k)
      keep_smaller(pair.vertex[static_cast<std::size_t>(k)], part_of(room, dx.col(k).norm()));
    return;
  }
  const Closest<double, N> closest = closest_points<K, double>(x);
  const bool apart = closest.d > 0;
  const Vec3d n = apart ? Vec3d(closest.r / closest.d) : Vec3d(Vec3d::Zero());
  SideOf of[N];
  for (int k = 0; k < N; ++k) {
    const double along = n.dot(dx.col(k));
    of[k] = {n.dot(x.col(k) - x.col(0)), apart ? (k < split ? -along : along) : dx.col(k).norm(),
             closest.weights[k] != 0};
  }
  divide<N>(pair.vertex, split, of, pair.law.offset + floor);
}

/// Beyond a plane, a ball or a cylinder every plane across the closest points has the obstacle on its other side; inside a
/// ball or a cylinder, which is convex, a vertex has a ball of its own.
template <int N>
void VertexBounds::bound_at_obstacle(const std::array<int, N>& vertex, const Side& law,
                                     const AnalyticSurface<double>& given, const Motion& motion) {
  const AnalyticSurface<double> s = posed(given, motion.x0), end = posed(given, motion.x1);
  const Mat<double, 3, N> x = gather(motion.x0, vertex), dx = gather(motion.x1, vertex) - x;
  const Vec3d moved = end.point - s.point;
  const double floor =
      floor_of(std::max({x.cwiseAbs().maxCoeff(), (x + dx).cwiseAbs().maxCoeff(),
                         s.point.cwiseAbs().maxCoeff(), end.point.cwiseAbs().maxCoeff(), s.radius}));
  const bool ball = rule_ == StepBoundRule::per_vertex || (s.inside && s.kind != ObstacleKind::plane);
  Vec3d n = s.axis;
  double gap = 0;
  bool carries[N] = {true};
  if constexpr (N == 1) {
    const SurfaceGap<double> at = surface_gap<double>(s, x);
    n = at.normal, gap = at.d;
  } else {
    const Closest<double, N + 1> closest =
        closest_points<centre_pair<N>, double>(about_centre<N, double>(s, x));
    n = closest.r / -closest.d, gap = closest.d - s.radius;
    for (int k = 0; k < N; ++k) carries[k] = closest.weights[k + 1] != 0;
  }
  const double own = s.vertex < 0 ? gamma_ : gamma_ / 2;
  if (ball) {
    const double room = own * (gap - law.offset - floor);
    for (int k = 0; k < N; ++k)
      keep_smaller(vertex[static_cast<std::size_t>(k)], part_of(room, dx.col(k).norm()));
    if (s.vertex >= 0) keep_smaller(s.vertex, part_of(room, moved.norm()));
    return;
  }
  // the obstacle is the other side: where it stands still its place in the list is that of a vertex that goes nowhere
  std::array<int, N + 1> all;
  SideOf of[N + 1];
  for (int k = 0; k < N; ++k) {
    all[static_cast<std::size_t>(k)] = vertex[static_cast<std::size_t>(k)];
    of[k] = {n.dot(x.col(k) - s.point), -n.dot(dx.col(k)), carries[k]};
  }
  all[N] = s.vertex < 0 ? vertex[0] : s.vertex;
  of[N] = {s.kind == ObstacleKind::plane ? 0 : s.radius, s.vertex < 0 ? 0 : n.dot(moved), true};
  divide<N + 1>(all, N, of, law.offset + floor);
}

StepBound VertexBounds::find(const Candidates& candidates, const PositionsView& x0, const PositionsView& x1) {
  const bool finite = x0.allFinite() && x1.allFinite();
  parts_.assign(static_cast<std::size_t>(x0.cols()), finite ? 1 : 0);
  const Motion motion{x0, x1};
  if (finite) {
    for_each_kind(candidates, [&]<PairKind K>(const std::vector<IndexPair>& pairs) {
      for_each_chunk(pairs.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) bound_pair<K>(contact_pair<K>(surface_, pairs[i]), motion);
      });
    });
    for_each_obstacle_list(
        surface_, candidates, [&]<int N>(const Primitives<N>& of, const std::vector<IndexPair>& pairs) {
          for_each_chunk(pairs.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
              const auto p = static_cast<std::size_t>(pairs[i].first);
              bound_at_obstacle<N>(of.vertices[p], of.side[p],
                                   obstacles_[static_cast<std::size_t>(pairs[i].second)], motion);
            }
          });
        });
  }
  StepBound out;
  const auto least = std::min_element(parts_.begin(), parts_.end());
  if (least == parts_.end() || *least == 1) return out;
  out.alpha = *least;
  out.kind = ContactKind::point_point;
  out.key = {static_cast<int>(least - parts_.begin()), -1, -1, -1};
  return out;
}

}  // namespace bb
