// A candidate pair as points and contact distances, whatever its kind: what the rows and the step bound
// share.
#pragma once

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
Mat<double, 3, static_cast<int>(N)> gather(const Positions& x, const std::array<int, N>& vertex) {
  Mat<double, 3, static_cast<int>(N)> out;
  for (std::size_t k = 0; k < N; ++k) out.col(static_cast<int>(k)) = x.col(vertex[k]);
  return out;
}

/// Distance between the boxes of the two primitives, each over all given sets of points: a cheap lower bound.
template <PairKind K, class... Points>
double pair_box_distance(const Points&... points) {
  Aabb a, b;
  const auto add = [&](const auto& x) {
    for (int k = 0; k < pair_points(K); ++k) (k < pair_split(K) ? a : b).add(Vec3d(x.col(k)));
  };
  (add(points), ...);
  return box_distance(a, b);
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
