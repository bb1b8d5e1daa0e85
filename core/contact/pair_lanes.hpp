// Candidate pairs of one kind side by side, four in double or eight in float: what is cheaply proven of all of them
// at once.
#pragma once

#include <array>
#include <limits>
#include <type_traits>

#include "core/contact/pair_geometry.hpp"
#include "core/contact/pair_planes.hpp"
#include "core/math/lanes.hpp"

namespace bb {

using Lanes4 = Lanes<double, 4>;
using Lanes8 = Lanes<float, 8>;
constexpr std::size_t n_lanes = 4;

template <PairKind K>
PairLanes<K, Lanes4> gather_lanes(const std::array<ContactPair<K>, n_lanes>& pairs, const PositionsView& x) {
  const auto coordinates = [&](std::size_t k, Lanes4(&out)[3]) {
    const double* const p[n_lanes] = {x.col(pairs[0].vertex[k]).data(), x.col(pairs[1].vertex[k]).data(),
                                      x.col(pairs[2].vertex[k]).data(), x.col(pairs[3].vertex[k]).data()};
    for (int c = 0; c < 3; ++c) out[c] = Lanes4::Vector{p[0][c], p[1][c], p[2][c], p[3][c]};
  };
  PairLanes<K, Lanes4> out;
  Lanes4 origin[3], point[3];
  coordinates(0, origin);
  for (Lanes4& c : out.x[0]) c = 0.0;
  for (int k = 1; k < pair_points(K); ++k) {
    coordinates(static_cast<std::size_t>(k), point);
    for (int c = 0; c < 3; ++c) out.x[k][c] = point[c] - origin[c];
  }
  return out;
}

/// The pairs of at most four indices; what is missing to four is made up by the first of them.
template <PairKind K, class Index>
std::array<ContactPair<K>, n_lanes> four_pairs(const Surface& surface, const std::vector<IndexPair>& pairs,
                                               std::size_t n, const Index& index) {
  std::array<ContactPair<K>, n_lanes> out;
  for (std::size_t lane = 0; lane < n_lanes; ++lane) {
    out[lane] = contact_pair<K>(surface, pairs[index(lane < n ? lane : 0)]);
  }
  return out;
}

/// Which of the pairs a plane proves to be farther apart than `reach` (m), however their distance is rounded.
/// As farther_than of one pair, and by the common normal of two edges or of a triangle too.
template <PairKind K>
Lanes8::Mask farther_than(const PairLanes<K, Lanes8>& points, const Lanes8& reach) {
  using L = Lanes8;
  const L level = reach + L(detail::pair_rounding<L>) * (reach + largest_coordinate(points));
  const L level_sq = level * level, zero(0);
  const L normal =
      0x1p-100F;  // products above it have lost no digit to underflow: a normal of tiny edges may
  L::Mask far = false;
  L r[3];
  const auto proves = [&](const L& room, const L& r_sq) {
    const L least_sq = level_sq * r_sq;
    return r_sq > normal && least_sq > normal && room > zero && room * room > least_sq;
  };
  detail::between_middles(points, r);
  for (int step = 0; step < detail::gilbert_steps; ++step) {
    const L r_sq = detail::dot(r, r);
    const L room = detail::gilbert_step(points, detail::Heights<K, L>(points, r), r, r_sq);
    far = far || proves(room, r_sq);
    if (!any(!far)) return far;
  }
  if constexpr (K == PairKind::edge_edge || K == PairKind::point_triangle) {
    detail::common_normal(points, r);  // Gilbert's steps turn to it slowly
    far = far || proves(detail::room(detail::Heights<K, L>(points, r)), detail::dot(r, r));
  }
  return far;
}

}  // namespace bb
