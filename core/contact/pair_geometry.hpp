// A candidate pair as points and contact distances, whatever its kind: what the rows and the
// step bound share.
#pragma once

#include <algorithm>
#include <array>

#include "core/contact/aabb.hpp"
#include "core/contact/bvh.hpp"
#include "core/contact/surface.hpp"
#include "core/geometry/closest_points.hpp"
#include "core/geometry/pair.hpp"

namespace bb {

/// Vertices of a pair in the order of pair.hpp, and the gap law of its two sides.
template <PairKind K>
struct ContactPair {
  std::array<int, pair_points(K)> vertex;
  Side law;
};

template <PairKind K>
ContactPair<K> contact_pair(const Surface& s, IndexPair pair) {
  const auto join = [](const auto& a, std::size_t i, const auto& b, std::size_t j) {
    ContactPair<K> out;
    std::size_t k = 0;
    for (int v : a.vertices[i]) out.vertex[k++] = v;
    for (int v : b.vertices[j]) out.vertex[k++] = v;
    out.law = combine(a.side[i], b.side[j]);
    return out;
  };
  const std::size_t i = static_cast<std::size_t>(pair.first), j = static_cast<std::size_t>(pair.second);
  if constexpr (K == PairKind::point_point) return join(s.points, i, s.points, j);
  if constexpr (K == PairKind::point_edge) return join(s.points, i, s.edges, j);
  if constexpr (K == PairKind::point_triangle) return join(s.points, i, s.triangles, j);
  if constexpr (K == PairKind::edge_edge) return join(s.edges, i, s.edges, j);
}

template <std::size_t N>
Mat<double, 3, static_cast<int>(N)> gather(const PositionsView& x, const std::array<int, N>& vertex) {
  Mat<double, 3, static_cast<int>(N)> out;
  for (std::size_t k = 0; k < N; ++k) out.col(static_cast<int>(k)) = x.col(vertex[k]);
  return out;
}

/// The same in the scalar T.
template <class T, std::size_t N>
Mat<T, 3, static_cast<int>(N)> gather_in(const PositionsView& x, const std::array<int, N>& vertex) {
  return gather(x, vertex).template cast<T>();
}

/// Distance between the boxes of the two primitives, each over all given sets of points: a cheap lower bound.
template <PairKind K, class... Points>
BB_HD double pair_box_distance(const Points&... points) {
  Aabb a, b;
  const auto add = [&](const auto& x) {
    for (int k = 0; k < pair_points(K); ++k) (k < pair_split(K) ? a : b).add(Vec3d(x.col(k)));
  };
  (add(points), ...);
  return box_distance(a, b);
}

/// True when a plane between the two primitives proves that their distance, however it is rounded, is more
/// than `reach`; false proves nothing. A few steps of Gilbert's method on the differences of their points,
/// which settle nearly every pair that is not close: a tenth of the cost of the closest points.
template <PairKind K>
BB_HD bool farther_than(const Mat<double, 3, pair_points(K)>& points, double reach) {
  constexpr int N = pair_points(K), split = pair_split(K), steps = 4;
  const Mat<double, 3, N> x = points.colwise() - points.col(0);
  // closest points, and what follows here, are right to a few eps of the pair's size
  const double level = reach + 1e-12 * (reach + x.cwiseAbs().maxCoeff());
  Vec3d r =
      x.template leftCols<split>().rowwise().mean() - x.template rightCols<N - split>().rowwise().mean();
  for (int step = 0; step < steps; ++step) {
    const Vec<double, N> height = x.transpose() * r;
    int i = 0, j = split;  // the points nearest to such a plane with normal r
    for (int k = 1; k < split; ++k) i = height[k] < height[i] ? k : i;
    for (int k = split + 1; k < N; ++k) j = height[k] > height[j] ? k : j;
    const double room = height[i] - height[j], r_sq = r.squaredNorm();
    if (room > 0 && room * room > level * level * r_sq) return true;
    // on to the point nearest to the origin between r and the difference of those two
    const Vec3d to = x.col(i) - x.col(j) - r;
    r += std::min(1.0, (r_sq - room) / to.squaredNorm()) * to;
  }
  return false;
}

/// Calls f.template operator()<K>(candidates of kind K) for the four kinds, in a fixed order.
template <class CandidateLists, class F>
void for_each_kind(CandidateLists& c, const F& f) {
  f.template operator()<PairKind::point_point>(c.point_point);
  f.template operator()<PairKind::point_edge>(c.point_edge);
  f.template operator()<PairKind::point_triangle>(c.point_triangle);
  f.template operator()<PairKind::edge_edge>(c.edge_edge);
}

}  // namespace bb
