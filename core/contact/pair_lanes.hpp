// Four candidate pairs of one kind side by side: what is cheaply proven of all of them at once.
#pragma once

#include <array>
#include <limits>

#include "core/contact/pair_geometry.hpp"
#include "core/math/lanes.hpp"

namespace bb {

using Lanes4 = Lanes<double, 4>;
constexpr std::size_t n_lanes = 4;

/// Points (m) or displacements (m) of four pairs, relative to the first point of each.
template <PairKind K>
struct PairLanes {
  Lanes4 x[pair_points(K)][3];
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

/// Asks the memory for what a pair will need, a few pairs ahead: the second primitive of a candidate jumps about
/// (the first stays for a run of them). `fetch_points` reads what `fetch_primitive` asked for.
template <PairKind K>
void fetch_primitive(const Surface& s, IndexPair pair) {
  const auto fetch = [j = static_cast<std::size_t>(pair.second)](const auto& primitives) {
    __builtin_prefetch(&primitives.vertices[j]);
    __builtin_prefetch(&primitives.side[j]);
  };
  if constexpr (K == PairKind::point_point) return fetch(s.points);
  if constexpr (K == PairKind::point_triangle) return fetch(s.triangles);
  fetch(s.edges);
}
template <PairKind K>
void fetch_points(const Surface& s, IndexPair pair, const Positions& x) {
  const auto fetch = [&](const auto& primitives) {
    for (const int v : primitives.vertices[static_cast<std::size_t>(pair.second)]) {
      __builtin_prefetch(x.col(v).data());
    }
  };
  if constexpr (K == PairKind::point_point) return fetch(s.points);
  if constexpr (K == PairKind::point_triangle) return fetch(s.triangles);
  fetch(s.edges);
}

/// The largest |coordinate| of each pair.
template <PairKind K>
Lanes4 largest_coordinate(const PairLanes<K>& pairs) {
  Lanes4 out = 0.0;
  for (const auto& point : pairs.x) {
    for (const Lanes4& c : point) {
      const Lanes4 size = abs(c);
      out = select(size > out, size, out);
    }
  }
  return out;
}

namespace detail {

inline Lanes4 dot(const Lanes4 (&a)[3], const Lanes4 (&b)[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Lanes4 least(const Lanes4& a, const Lanes4& b) { return select(a < b, a, b); }

/// Heights of all points along r.
template <PairKind K>
struct Heights {
  Lanes4 of[pair_points(K)];
  Heights(const PairLanes<K>& points, const Lanes4 (&r)[3]) {
    for (int k = 0; k < pair_points(K); ++k) of[k] = dot(points.x[k], r);
  }
};

/// From the middle of the second primitive to that of the first.
template <PairKind K>
void between_middles(const PairLanes<K>& p, Lanes4 (&r)[3]) {
  constexpr int split = pair_split(K), N = pair_points(K);
  for (int c = 0; c < 3; ++c) {
    Lanes4 first = 0.0, second = 0.0;
    for (int k = 0; k < split; ++k) first += p.x[k][c];
    for (int k = split; k < N; ++k) second += p.x[k][c];
    r[c] = first * Lanes4(1.0 / split) - second * Lanes4(1.0 / (N - split));
  }
}

/// Gilbert's step: r becomes the point nearest to the origin between r and the difference of the two points
/// that are nearest to a plane with normal r; their room is returned.
template <PairKind K>
Lanes4 gilbert_step(const PairLanes<K>& p, const Heights<K>& height, Lanes4 (&r)[3], const Lanes4& r_sq) {
  constexpr int split = pair_split(K), N = pair_points(K);
  Lanes4 low = height.of[0], high = height.of[split];
  Lanes4 to[3], from[3];
  for (int c = 0; c < 3; ++c) to[c] = p.x[0][c], from[c] = p.x[split][c];
  for (int k = 1; k < N; ++k) {
    if (k == split) continue;
    const auto nearer = k < split ? height.of[k] < low : height.of[k] > high;
    Lanes4& level = k < split ? low : high;
    Lanes4(&point)[3] = k < split ? to : from;
    level = select(nearer, height.of[k], level);
    for (int c = 0; c < 3; ++c) point[c] = select(nearer, p.x[k][c], point[c]);
  }
  for (int c = 0; c < 3; ++c) to[c] = to[c] - from[c] - r[c];
  const Lanes4 room = low - high;
  const Lanes4 part = least((r_sq - room) / dot(to, to), Lanes4(1.0));
  for (int c = 0; c < 3; ++c) r[c] += part * to[c];
  return room;
}

constexpr int gilbert_steps = 4;
constexpr double pair_rounding =
    1e-12;  // of lengths of a pair relative to its size: a few eps and ample room

}  // namespace detail

/// Which of four pairs a plane proves to be farther apart than `reach` (m), however their distance is rounded.
/// As farther_than, which proves the same of one pair.
template <PairKind K>
LaneMask<double, 4> farther_than(const PairLanes<K>& points, const Lanes4& reach) {
  const Lanes4 level = reach + Lanes4(detail::pair_rounding) * (reach + largest_coordinate(points));
  const Lanes4 level_sq = level * level, zero = 0.0;
  LaneMask<double, 4> far = false;
  Lanes4 r[3];
  detail::between_middles(points, r);
  for (int step = 0; step < detail::gilbert_steps; ++step) {
    const Lanes4 r_sq = detail::dot(r, r);
    const Lanes4 room = detail::gilbert_step(points, detail::Heights<K>(points, r), r, r_sq);
    far = far || (room > zero && room * room > level_sq * r_sq);
    if (!any(!far)) break;
  }
  return far;
}

namespace detail {

/// Until when a plane with normal r keeps the pairs farther apart than `level` (m): every two points of the
/// primitives close at a constant speed, known to `slack` (m per unit of time). 0 when it does not now.
template <PairKind K>
Lanes4 plane_holds(const Heights<K>& height, const Heights<K>& speed, const Lanes4& length,
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

/// The common normal of two edges, or that of a triangle, on the side of the first primitive.
template <PairKind K>
void common_normal(const PairLanes<K>& p, Lanes4 (&r)[3]) {
  constexpr int from[2] = {K == PairKind::edge_edge ? 0 : 1, K == PairKind::edge_edge ? 2 : 1};
  constexpr int to[2] = {K == PairKind::edge_edge ? 1 : 2, 3};
  Lanes4 e[3], f[3], middle[3];
  for (int c = 0; c < 3; ++c) {
    e[c] = p.x[to[0]][c] - p.x[from[0]][c];
    f[c] = p.x[to[1]][c] - p.x[from[1]][c];
  }
  for (int c = 0; c < 3; ++c) r[c] = e[(c + 1) % 3] * f[(c + 2) % 3] - e[(c + 2) % 3] * f[(c + 1) % 3];
  between_middles(p, middle);
  const auto away = dot(r, middle) < Lanes4(0.0);
  for (Lanes4& c : r) c = select(away, -c, c);
}

}  // namespace detail

/// Times before which four pairs that move by `motion` per unit of time are proven farther apart than `reach`,
/// by a few planes; 0 when nothing is proven. No more planes are tried once all are above `enough`.
template <PairKind K>
Lanes4 proven_times(const PairLanes<K>& points, const PairLanes<K>& motion, const Lanes4& reach,
                    double enough) {
  const Lanes4 rounding = detail::pair_rounding, size = largest_coordinate(points);
  const Lanes4 slack = rounding * (size + largest_coordinate(motion));
  const Lanes4 level = reach + rounding * (reach + size);
  Lanes4 best = 0.0, r[3];
  const auto settled = [&](const detail::Heights<K>& height, const Lanes4& r_sq) {
    const Lanes4 until =
        detail::plane_holds<K>(height, detail::Heights<K>(motion, r), sqrt(r_sq), level, slack);
    best = select(until > best, until, best);
    return !any(best <= Lanes4(enough));
  };
  detail::between_middles(points, r);
  bool done = false;
  for (int step = 0; step < detail::gilbert_steps && !done; ++step) {
    const Lanes4 r_sq = detail::dot(r, r);
    const detail::Heights<K> height(points, r);
    done = settled(height, r_sq);
    if (!done) detail::gilbert_step(points, height, r, r_sq);
  }
  if constexpr (K == PairKind::edge_edge || K == PairKind::point_triangle) {
    if (!done) {  // primitives that cross at a small distance: Gilbert's steps turn to their normal slowly
      detail::common_normal(points, r);
      settled(detail::Heights<K>(points, r), detail::dot(r, r));
    }
  }
  return best * (Lanes4(1.0) - rounding);
}

}  // namespace bb
