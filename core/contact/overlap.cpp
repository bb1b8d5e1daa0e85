#include "core/contact/overlap.hpp"

#include <algorithm>

#include "core/contact/chunks.hpp"
#include "core/contact/obstacle_pair.hpp"
#include "core/contact/pair_geometry.hpp"
#include "core/contact/pair_row.hpp"

namespace bb {
namespace {

template <PairKind K>
std::optional<Overlap> pair_overlap(const Surface& surface, const PositionsView& x, IndexPair index) {
  const ContactPair<K> pair = contact_pair<K>(surface, index);
  const auto points = gather(x, pair.vertex);
  if (farther_than<K>(points, pair.law.offset)) return std::nullopt;
  const double gap = closest_points<K, double>(points).d - pair.law.offset;
  if (gap > 0) return std::nullopt;
  return Overlap{contact_kind<K>(), pair_key(pair.vertex), gap, {}};
}

template <int N>
std::optional<Overlap> obstacle_overlap(const Primitives<N>& primitives, const AnalyticSurface<double>& given,
                                        const PositionsView& x, IndexPair index) {
  const AnalyticSurface<double> obstacle = posed(given, x);
  const std::size_t i = static_cast<std::size_t>(index.first);
  const auto& vertex = primitives.vertices[i];
  const Mat<double, 3, N> at = gather(x, vertex);
  double distance = 0;
  if constexpr (N == 1) {
    distance = surface_gap<double>(obstacle, at).d;
  } else {
    const auto closest = closest_points<centre_pair<N>, double>(about_centre<N, double>(obstacle, at));
    distance = closest.d - obstacle.radius;
  }
  const double gap = distance - primitives.side[i].offset;
  if (gap > 0) return std::nullopt;
  return Overlap{static_cast<ContactKind>(obstacle_pairs_of<N>), obstacle_key(index.second, vertex), gap, {}};
}

/// Twice the signed area of 0, a, b as they are seen along the axis, m^2.
double turn(const Vec3d& axis, const Vec3d& a, const Vec3d& b) { return axis.dot(a.cross(b)); }

/// Whether a triangle is on both sides of the axis of an obstacle: its sides, far away, show nothing of that.
bool holds_axis(const AnalyticSurface<double>& obstacle, const Vec3d& axis, const Mat3d& corners) {
  const Mat3d p = corners.colwise() - obstacle.point;
  const double turns[] = {turn(axis, p.col(0), p.col(1)), turn(axis, p.col(1), p.col(2)),
                          turn(axis, p.col(2), p.col(0))};
  const auto [low, high] = std::minmax_element(std::begin(turns), std::end(turns));
  return *low * *high > 0;
}

/// Triangles that a cylinder, or in the plane a disk, pierces between their sides.
std::optional<Overlap> first_pierced(const Surface& surface,
                                     const std::vector<AnalyticSurface<double>>& obstacles,
                                     const PositionsView& x) {
  for (std::size_t o = 0; o < obstacles.size(); ++o) {
    const AnalyticSurface<double> obstacle = posed(obstacles[o], x);
    const bool line = is_line(obstacle, surface.planar);
    if (is_convex(obstacle) || (!surface.planar && !line) || (surface.planar && line)) continue;
    const auto is_off = [&](int v) {
      return surface.collisions.chosen() &&
             surface.kind_at_obstacle(v, static_cast<int>(o)) == CollisionKind::off;
    };
    const Vec3d axis = obstacle.kind == ObstacleKind::cylinder ? obstacle.axis : Vec3d(Vec3d::UnitZ());
    for (const auto& triangle : surface.filled) {
      if (is_off(triangle[0]) || !holds_axis(obstacle, axis, gather(x, triangle))) continue;
      return Overlap{
          ContactKind::obstacle_triangle, obstacle_key(static_cast<int>(o), triangle), -obstacle.radius, {}};
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<Overlap> first_overlap(const Surface& surface,
                                     const std::vector<AnalyticSurface<double>>& obstacles,
                                     const Candidates& candidates, const PositionsView& x) {
  std::optional<Overlap> first;
  const auto scan = [&](const std::vector<IndexPair>& pairs, const auto& test) {
    over_chunks<std::optional<Overlap>>(
        pairs,
        [&](IndexPair pair, std::optional<Overlap>& found) {
          if (!found) found = test(pair);
        },
        [&](const std::optional<Overlap>& found) {
          if (!first) first = found;
        });
  };
  for_each_kind(candidates, [&]<PairKind K>(const std::vector<IndexPair>& pairs) {
    scan(pairs, [&](IndexPair pair) { return pair_overlap<K>(surface, x, pair); });
  });
  for_each_obstacle_list(
      surface, candidates, [&]<int N>(const Primitives<N>& primitives, const std::vector<IndexPair>& pairs) {
        scan(pairs, [&](IndexPair pair) {
          return obstacle_overlap<N>(primitives, obstacles[static_cast<std::size_t>(pair.second)], x, pair);
        });
      });
  return first ? first : first_pierced(surface, obstacles, x);
}

}  // namespace bb
