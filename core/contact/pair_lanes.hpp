// Candidate pairs of one kind side by side, four in double or eight in float: what is cheaply proven of all of them
// at once.
#pragma once

#include <array>
#include <limits>
#include <type_traits>

#include "core/contact/pair_geometry.hpp"
#include "core/math/lanes.hpp"

namespace bb {

using Lanes4 = Lanes<double, 4>;
using Lanes8 = Lanes<float, 8>;
constexpr std::size_t n_lanes = 4;

/// Points (m) or displacements (m) of four (eight) pairs, relative to the first point of each.
template <PairKind K, class L = Lanes4>
struct PairLanes {
  L x[pair_points(K)][3];
};

template <PairKind K>
PairLanes<K> operator-(const PairLanes<K>& a, const PairLanes<K>& b) {
  PairLanes<K> out;
  for (int k = 0; k < pair_points(K); ++k) {
    for (int c = 0; c < 3; ++c) out.x[k][c] = a.x[k][c] - b.x[k][c];
  }
  return out;
}

template <PairKind K>
PairLanes<K> gather_lanes(const std::array<ContactPair<K>, n_lanes>& pairs, const Positions& x) {
  const auto coordinates = [&](std::size_t k, Lanes4(&out)[3]) {
    const double* const p[n_lanes] = {x.col(pairs[0].vertex[k]).data(), x.col(pairs[1].vertex[k]).data(),
                                      x.col(pairs[2].vertex[k]).data(), x.col(pairs[3].vertex[k]).data()};
    for (int c = 0; c < 3; ++c) out[c] = Lanes4::Vector{p[0][c], p[1][c], p[2][c], p[3][c]};
  };
  PairLanes<K> out;
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

/// The largest |coordinate| of each pair.
template <PairKind K, class L>
L largest_coordinate(const PairLanes<K, L>& pairs) {
  L out(0);
  for (const auto& point : pairs.x) {
    for (const L& c : point) {
      const L size = abs(c);
      out = select(size > out, size, out);
    }
  }
  return out;
}

namespace detail {

template <class L>
using scalar = typename ScalarOf<L>::type;

/// Of lengths of a pair relative to its size. With u the unit roundoff and S the size, a height and the difference of
/// two are off by at most 14 u S |r|, differences from the first point by 4 u S, the squares that are compared by
/// 6 u of the level: 28 u (S + level), against 33 u in float; far more in double.
template <class L>
constexpr scalar<L> pair_rounding = std::is_same_v<scalar<L>, float> ? scalar<L>(2e-6) : scalar<L>(1e-12);

template <class L>
L dot(const L (&a)[3], const L (&b)[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class L>
L least(const L& a, const L& b) {
  return select(a < b, a, b);
}

/// Heights of all points along r.
template <PairKind K, class L>
struct Heights {
  L of[pair_points(K)];
  Heights(const PairLanes<K, L>& points, const L (&r)[3]) {
    for (int k = 0; k < pair_points(K); ++k) of[k] = dot(points.x[k], r);
  }
};

/// How far the first primitive is above the second, where it is lowest and the second highest.
template <PairKind K, class L>
L room(const Heights<K, L>& height) {
  constexpr int split = pair_split(K), N = pair_points(K);
  L low = height.of[0], high = height.of[split];
  for (int k = 1; k < split; ++k) low = select(height.of[k] < low, height.of[k], low);
  for (int k = split + 1; k < N; ++k) high = select(height.of[k] > high, height.of[k], high);
  return low - high;
}

/// From the middle of the second primitive to that of the first.
template <PairKind K, class L>
void between_middles(const PairLanes<K, L>& p, L (&r)[3]) {
  constexpr int split = pair_split(K), N = pair_points(K);
  for (int c = 0; c < 3; ++c) {
    L first(0), second(0);
    for (int k = 0; k < split; ++k) first += p.x[k][c];
    for (int k = split; k < N; ++k) second += p.x[k][c];
    r[c] = first * L(scalar<L>(1) / split) - second * L(scalar<L>(1) / (N - split));
  }
}

/// Gilbert's step: r becomes the point nearest to the origin between r and the difference of the two points
/// that are nearest to a plane with normal r; their room is returned.
template <PairKind K, class L>
L gilbert_step(const PairLanes<K, L>& p, const Heights<K, L>& height, L (&r)[3], const L& r_sq) {
  constexpr int split = pair_split(K), N = pair_points(K);
  L low = height.of[0], high = height.of[split];
  L to[3], from[3];
  for (int c = 0; c < 3; ++c) to[c] = p.x[0][c], from[c] = p.x[split][c];
  for (int k = 1; k < N; ++k) {
    if (k == split) continue;
    const typename L::Mask nearer = k < split ? height.of[k] < low : height.of[k] > high;
    L& level = k < split ? low : high;
    L(&point)[3] = k < split ? to : from;
    level = select(nearer, height.of[k], level);
    for (int c = 0; c < 3; ++c) point[c] = select(nearer, p.x[k][c], point[c]);
  }
  for (int c = 0; c < 3; ++c) to[c] = to[c] - from[c] - r[c];
  const L room = low - high;
  const L part = least((r_sq - room) / dot(to, to), L(1));
  for (int c = 0; c < 3; ++c) r[c] += part * to[c];
  return room;
}

/// The common normal of two edges, or that of a triangle, on the side of the first primitive.
template <PairKind K, class L>
void common_normal(const PairLanes<K, L>& p, L (&r)[3]) {
  constexpr int from[2] = {K == PairKind::edge_edge ? 0 : 1, K == PairKind::edge_edge ? 2 : 1};
  constexpr int to[2] = {K == PairKind::edge_edge ? 1 : 2, 3};
  L e[3], f[3], middle[3];
  for (int c = 0; c < 3; ++c) {
    e[c] = p.x[to[0]][c] - p.x[from[0]][c];
    f[c] = p.x[to[1]][c] - p.x[from[1]][c];
  }
  for (int c = 0; c < 3; ++c) r[c] = e[(c + 1) % 3] * f[(c + 2) % 3] - e[(c + 2) % 3] * f[(c + 1) % 3];
  between_middles(p, middle);
  const auto away = dot(r, middle) < L(0);
  for (L& c : r) c = select(away, -c, c);
}

constexpr int gilbert_steps = 4;

}  // namespace detail

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

namespace detail {

/// Until when a plane with normal r keeps the pairs farther apart than `level` (m): every two points of the
/// primitives close at a constant speed, known to `slack` (m per unit of time). 0 when it does not now.
template <PairKind K>
Lanes4 plane_holds(const Heights<K, Lanes4>& height, const Heights<K, Lanes4>& speed, const Lanes4& length,
                   const Lanes4& level, const Lanes4& slack) {
  constexpr int split = pair_split(K), N = pair_points(K);
  const Lanes4 zero = 0.0, never = std::numeric_limits<double>::infinity();
  const Lanes4 least_room = level * length, least_closing = slack * length;
  Lanes4 until = never;
  for (int i = 0; i < split; ++i) {
    for (int j = split; j < N; ++j) {
      const Lanes4 room = height.of[i] - height.of[j] - least_room;
      const Lanes4 closing = speed.of[j] - speed.of[i] + least_closing;
      const Lanes4 met = select(closing > zero, room / closing, never);
      until = least(until, select(room > zero, met, zero));
    }
  }
  return until;
}

}  // namespace detail

/// Times before which four pairs that move by `motion` per unit of time are proven farther apart than `reach`,
/// by a few planes; 0 when nothing is proven. No more planes are tried once all are above `enough`.
template <PairKind K>
Lanes4 proven_times(const PairLanes<K>& points, const PairLanes<K>& motion, const Lanes4& reach,
                    double enough) {
  const Lanes4 rounding = detail::pair_rounding<Lanes4>, size = largest_coordinate(points);
  const Lanes4 slack = rounding * (size + largest_coordinate(motion));
  const Lanes4 level = reach + rounding * (reach + size);
  Lanes4 best = 0.0, r[3];
  const auto settled = [&](const detail::Heights<K, Lanes4>& height, const Lanes4& r_sq) {
    const Lanes4 until =
        detail::plane_holds<K>(height, detail::Heights<K, Lanes4>(motion, r), sqrt(r_sq), level, slack);
    best = select(until > best, until, best);
    return !any(best <= Lanes4(enough));
  };
  detail::between_middles(points, r);
  bool done = false;
  for (int step = 0; step < detail::gilbert_steps && !done; ++step) {
    const Lanes4 r_sq = detail::dot(r, r);
    const detail::Heights<K, Lanes4> height(points, r);
    done = settled(height, r_sq);
    if (!done) detail::gilbert_step(points, height, r, r_sq);
  }
  if constexpr (K == PairKind::edge_edge || K == PairKind::point_triangle) {
    if (!done) {  // primitives that cross at a small distance: Gilbert's steps turn to their normal slowly
      detail::common_normal(points, r);
      settled(detail::Heights<K, Lanes4>(points, r), detail::dot(r, r));
    }
  }
  return best * (Lanes4(1.0) - rounding);
}

}  // namespace bb
