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
  PairLanes<K> out;
  for (std::size_t lane = 0; lane < n_lanes; ++lane) {
    const double* const origin = x.col(pairs[lane].vertex[0]).data();
    for (std::size_t k = 0; k < pairs[lane].vertex.size(); ++k) {
      const double* const point = x.col(pairs[lane].vertex[k]).data();
      for (int c = 0; c < 3; ++c) out.x[k][c].v[lane] = point[c] - origin[c];
    }
  }
  return out;
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

/// Times before which four pairs that move by `motion` per unit of time are proven farther apart than `reach`:
/// along each of a few planes every two points of theirs close at a constant speed. 0 when nothing is proven;
/// settled once all are above `enough`.
template <PairKind K>
Lanes4 proven_times(const PairLanes<K>& points, const PairLanes<K>& motion, const Lanes4& reach,
                    double enough) {
  constexpr int split = pair_split(K), N = pair_points(K);
  const Lanes4 zero = 0.0, never = std::numeric_limits<double>::infinity();
  const Lanes4 rounding = detail::pair_rounding, size = largest_coordinate(points);
  const Lanes4 slack = rounding * (size + largest_coordinate(motion));  // m per unit of time
  const Lanes4 level = reach + rounding * (reach + size);
  Lanes4 best = zero, r[3];
  detail::between_middles(points, r);
  for (int step = 0; step < detail::gilbert_steps; ++step) {
    const Lanes4 r_sq = detail::dot(r, r), length = sqrt(r_sq);
    const detail::Heights<K> height(points, r), speed(motion, r);
    const Lanes4 least_room = level * length, least_closing = slack * length;
    Lanes4 until = never;
    for (int i = 0; i < split; ++i) {
      for (int j = split; j < N; ++j) {
        const Lanes4 room = height.of[i] - height.of[j] - least_room;
        const Lanes4 closing = speed.of[j] - speed.of[i] + least_closing;
        const Lanes4 met = select(closing > zero, room / closing, never);
        until = detail::least(until, select(room > zero, met, zero));
      }
    }
    best = select(until > best, until, best);
    if (!any(best <= Lanes4(enough))) break;
    detail::gilbert_step(points, height, r, r_sq);
  }
  return best * (Lanes4(1.0) - rounding);
}

}  // namespace bb
