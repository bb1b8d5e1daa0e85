// Planes between the two primitives of a pair: what they prove of its distance, now and on a straight motion.
// L: one number, for one pair, or several side by side (lanes.hpp).
#pragma once

#include <cmath>
#include <limits>
#include <type_traits>

#include "core/geometry/pair.hpp"
#include "core/math/host_device.hpp"
#include "core/math/select.hpp"

namespace bb {

/// Points (m) or displacements (m) of a pair, or of one a lane, relative to the first point of each.
template <PairKind K, class L>
struct PairLanes {
  L x[pair_points(K)][3];
};

template <PairKind K, class L>
BB_HD PairLanes<K, L> operator-(const PairLanes<K, L>& a, const PairLanes<K, L>& b) {
  PairLanes<K, L> out;
  for (int k = 0; k < pair_points(K); ++k) {
    for (int c = 0; c < 3; ++c) out.x[k][c] = a.x[k][c] - b.x[k][c];
  }
  return out;
}

/// The largest |coordinate| of each pair.
template <PairKind K, class L>
BB_HD L largest_coordinate(const PairLanes<K, L>& pairs) {
  using std::abs;
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
BB_HD L dot(const L (&a)[3], const L (&b)[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class L>
BB_HD L least(const L& a, const L& b) {
  return select(a < b, a, b);
}

/// Heights of all points along r.
template <PairKind K, class L>
struct Heights {
  L of[pair_points(K)];
  BB_HD Heights(const PairLanes<K, L>& points, const L (&r)[3]) {
    for (int k = 0; k < pair_points(K); ++k) of[k] = dot(points.x[k], r);
  }
};

/// How far the first primitive is above the second, where it is lowest and the second highest.
template <PairKind K, class L>
BB_HD L room(const Heights<K, L>& height) {
  constexpr int split = pair_split(K), N = pair_points(K);
  L low = height.of[0], high = height.of[split];
  for (int k = 1; k < split; ++k) low = select(height.of[k] < low, height.of[k], low);
  for (int k = split + 1; k < N; ++k) high = select(height.of[k] > high, height.of[k], high);
  return low - high;
}

/// From the middle of the second primitive to that of the first.
template <PairKind K, class L>
BB_HD void between_middles(const PairLanes<K, L>& p, L (&r)[3]) {
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
BB_HD L gilbert_step(const PairLanes<K, L>& p, const Heights<K, L>& height, L (&r)[3], const L& r_sq) {
  constexpr int split = pair_split(K), N = pair_points(K);
  L low = height.of[0], high = height.of[split];
  L to[3], from[3];
  for (int c = 0; c < 3; ++c) to[c] = p.x[0][c], from[c] = p.x[split][c];
  for (int k = 1; k < N; ++k) {
    if (k == split) continue;
    const MaskOf<L> nearer = k < split ? height.of[k] < low : height.of[k] > high;
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
BB_HD void common_normal(const PairLanes<K, L>& p, L (&r)[3]) {
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

/// Until when a plane with normal r keeps the pairs farther apart than `level` (m): every two points of the
/// primitives close at a constant speed, known to `slack` (m per unit of time). 0 when it does not now, or where a
/// height or a speed is NaN.
template <PairKind K, class L>
BB_HD L plane_holds(const Heights<K, L>& height, const Heights<K, L>& speed, const L& length, const L& level,
                    const L& slack) {
  constexpr int split = pair_split(K), N = pair_points(K);
  const L zero(0), never(std::numeric_limits<scalar<L>>::infinity());
  const L least_room = level * length, least_closing = slack * length;
  L until = never;
  for (int i = 0; i < split; ++i) {
    for (int j = split; j < N; ++j) {
      const L room = height.of[i] - height.of[j] - least_room;
      const L closing = speed.of[j] - speed.of[i] + least_closing;
      const L met = select(closing > zero, room / closing, select(closing <= zero, never, zero));
      until = least(until, select(room > zero, met, zero));
    }
  }
  return until;
}

}  // namespace detail

/// Times before which pairs that move by `motion` per unit of time are proven farther apart than `reach`,
/// by a few planes; 0 when nothing is proven. No more planes are tried once all are above `enough`.
template <PairKind K, class L>
BB_HD L proven_times(const PairLanes<K, L>& points, const PairLanes<K, L>& motion, const L& reach,
                     detail::scalar<L> enough) {
  using std::sqrt;
  const L rounding(detail::pair_rounding<L>), size = largest_coordinate(points);
  const L slack = rounding * (size + largest_coordinate(motion));
  const L level = reach + rounding * (reach + size);
  L best(0), r[3];
  const auto settled = [&](const detail::Heights<K, L>& height, const L& r_sq) {
    const L until =
        detail::plane_holds<K, L>(height, detail::Heights<K, L>(motion, r), sqrt(r_sq), level, slack);
    best = select(until > best, until, best);
    return !any(best <= L(enough));
  };
  detail::between_middles(points, r);
  bool done = false;
  for (int step = 0; step < detail::gilbert_steps && !done; ++step) {
    const L r_sq = detail::dot(r, r);
    const detail::Heights<K, L> height(points, r);
    done = settled(height, r_sq);
    if (!done) detail::gilbert_step(points, height, r, r_sq);
  }
  if constexpr (K == PairKind::edge_edge || K == PairKind::point_triangle) {
    if (!done) {  // primitives that cross at a small distance: Gilbert's steps turn to their normal slowly
      detail::common_normal(points, r);
      settled(detail::Heights<K, L>(points, r), detail::dot(r, r));
    }
  }
  return best * (L(1) - rounding);
}

/// The same by the three axes alone, for a tenth of the cost: heights and speeds are coordinates.
template <PairKind K, class L>
BB_HD L proven_times_by_axes(const PairLanes<K, L>& points, const PairLanes<K, L>& motion, const L& reach) {
  constexpr int split = pair_split(K), N = pair_points(K);
  const L rounding(detail::pair_rounding<L>), size = largest_coordinate(points);
  const L slack = rounding * (size + largest_coordinate(motion)), level = reach + rounding * (reach + size);
  const L zero(0), never(std::numeric_limits<detail::scalar<L>>::infinity());
  L best(0);
  // of each primitive along an axis: from `lo` to `hi`, and how fast its ends move at least and at most
  const auto until = [&](const L& room, const L& closing) {
    const L met = select(closing > zero, room / closing, select(closing <= zero, never, zero));
    return select(room > zero, met, zero);
  };
  for (int c = 0; c < 3; ++c) {
    L lo[2], hi[2], slowest[2], fastest[2];
    for (int side = 0; side < 2; ++side) {
      const int begin = side == 0 ? 0 : split, end = side == 0 ? split : N;
      lo[side] = hi[side] = points.x[begin][c];
      slowest[side] = fastest[side] = motion.x[begin][c];
      for (int k = begin + 1; k < end; ++k) {
        const L x = points.x[k][c], v = motion.x[k][c];
        lo[side] = select(x < lo[side], x, lo[side]), hi[side] = select(x > hi[side], x, hi[side]);
        slowest[side] = select(v < slowest[side], v, slowest[side]);
        fastest[side] = select(v > fastest[side], v, fastest[side]);
      }
    }
    for (int low = 0; low < 2; ++low) {
      const int high = 1 - low;
      const L met = until(lo[high] - hi[low] - level, fastest[low] - slowest[high] + slack);
      best = select(met > best, met, best);
    }
  }
  return best * (L(1) - rounding);
}

}  // namespace bb
