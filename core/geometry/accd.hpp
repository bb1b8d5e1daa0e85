// Additive continuous collision detection of ONE pair: how far it may move along straight vertex paths
// before its gap falls to a stop level. Every advance is proven; nothing is extrapolated. One code for
// float and double.
#pragma once

#include <cmath>
#include <limits>

#include "core/geometry/closest_points.hpp"
#include "core/geometry/pair.hpp"
#include "core/math/types.hpp"

namespace bb {

/// Outcome of one query. [0, toi) is proven free of contact.
template <class T>
struct AccdResult {
  T toi;                  // in [0, 1]; 1 without a hit
  bool hit;               // false: [0, toi] is proven to stay above the stop level, [0, 1] unless given up
  int probes;             // closest-point evaluations
  bool capped;            // stopped by max_probes: toi is the last proven time
  bool overlap_at_start;  // gap <= 0 at time 0; then toi = 0
};

namespace detail {

/// A pair's motion x + t dx relative to the pair's own centre, with its sizes.
template <class T, int N>
struct CentredMotion {
  Mat<T, 3, N> x, dx;
  T largest;  // |coordinate| at both ends, as given: what the rounding of a committed state is measured by
  T local;    // the same relative to the centre: what the rounding in here is measured by
};

template <class T, int N>
BB_HD inline CentredMotion<T, N> centre_motion(const Mat<T, 3, N>& x0, const Mat<T, 3, N>& x1, T offset,
                                               T computed_from) {
  CentredMotion<T, N> m;
  m.x = x0.colwise() - Vec<T, 3>(x0.rowwise().mean());
  m.dx = x1 - x0;
  const Vec<T, 3> drift = m.dx.rowwise().mean();
  m.dx = m.dx.colwise() - drift;
  const T at0 = x0.cwiseAbs().maxCoeff(), at1 = x1.cwiseAbs().maxCoeff();
  m.largest = at0 > at1 ? at0 : at1;
  m.largest = m.largest > offset ? m.largest : offset;
  m.largest = m.largest > computed_from ? m.largest : computed_from;
  const T local0 = m.x.cwiseAbs().maxCoeff(), local1 = (m.x + m.dx).cwiseAbs().maxCoeff();
  m.local = local0 > local1 ? local0 : local1;
  m.local = m.local > offset ? m.local : offset;
  m.local = m.local > computed_from ? m.local : computed_from;
  return m;
}

/// Largest relative displacement of a vertex of one primitive against a vertex of the other: the gap of two
/// points of the primitives cannot change faster. Infinite where a square is no finite number.
template <PairKind K, class T>
BB_HD inline T relative_speed(const Mat<T, 3, pair_points(K)>& dx) {
  using std::sqrt;
  T speed_sq = 0;
  for (int i = 0; i < pair_split(K); ++i) {
    for (int j = pair_split(K); j < pair_points(K); ++j) {
      const T s = (dx.col(i) - dx.col(j)).squaredNorm();
      if (!(s < std::numeric_limits<T>::infinity())) return std::numeric_limits<T>::infinity();
      speed_sq = speed_sq > s ? speed_sq : s;
    }
  }
  return sqrt(speed_sq);
}

/// First t > 0 with a + b t + c t^2 = 0, for a > 0; infinite when there is none, and 0 where the numbers do not show it:
/// one of them is NaN, or their squares are beyond the largest.
template <class T>
BB_HD inline T first_root(T a, T b, T c) {
  using std::sqrt;
  const T discriminant = b * b - 4 * a * c;
  if (c >= 0 && (b >= 0 || discriminant < 0)) return std::numeric_limits<T>::infinity();
  if (!(discriminant < std::numeric_limits<T>::infinity())) return T(0);
  const T root = sqrt(discriminant);
  return b > 0 ? (b + root) / (-2 * c) : 2 * a / (root - b);
}

/// The slowest turn of the unit normal n that keeps it at a right angle to the edges on which the closest
/// points slide, 1 per unit of time; 0 for a vertex against a vertex.
template <class T, int N>
BB_HD inline Vec<T, 3> turn_of_normal(const Mat<T, 3, N>& x, const Mat<T, 3, N>& dx, const Vec<T, 3>& n,
                                      Region region) {
  const FreeEdges edges = free_edges(region);
  if (edges.count == 0) return Vec<T, 3>::Zero();
  const Vec<T, 3> e = x.col(edges.to[0]) - x.col(edges.from[0]);
  const T tilt_e = n.dot(dx.col(edges.to[0]) - dx.col(edges.from[0]));
  if (N < 4 || edges.count == 1) return e * (-tilt_e / e.squaredNorm());
  const Vec<T, 3> f = x.col(edges.to[1]) - x.col(edges.from[1]);
  const T tilt_f = n.dot(dx.col(edges.to[1]) - dx.col(edges.from[1]));
  const Vec<T, 3> normal = accurate_cross(e, f);
  return (accurate_cross(f, normal) * tilt_e + accurate_cross(normal, e) * tilt_f) / -normal.squaredNorm();
}

/// Time from now until the gap along the direction m(s) = n + s turn may fall below `level`; 0 when it proves
/// nothing, as with numbers that are not finite. The distance is at least the least m . (x_i - x_j)/|m| over the vertices of the two primitives;
/// with |m| <= 1 + s^2 |turn|^2/2 that is one quadratic in time for each pair of vertices, affine for turn =
/// 0. True for any turn; limited to about one radian, where rounding is no larger than without.
template <PairKind K, class T>
BB_HD inline T directional_advance(const Mat<T, 3, pair_points(K)>& x, const Mat<T, 3, pair_points(K)>& dx,
                                   const Vec<T, 3>& n, const Vec<T, 3>& turn, T level) {
  using std::sqrt;
  const T turn_sq = turn.squaredNorm();
  if (!(turn_sq < std::numeric_limits<T>::infinity())) return T(0);
  T advance = turn_sq > 0 ? 1 / sqrt(turn_sq) : std::numeric_limits<T>::infinity();
  for (int i = 0; i < pair_split(K); ++i) {
    for (int j = pair_split(K); j < pair_points(K); ++j) {
      const Vec<T, 3> r = x.col(i) - x.col(j), v = dx.col(i) - dx.col(j);
      const T room = n.dot(r) - level;
      if (!(room > 0)) return T(0);
      const T until = first_root<T>(room, n.dot(v) + turn.dot(r), turn.dot(v) - level * turn_sq / 2);
      if (!(until > 0)) return T(0);
      advance = until < advance ? until : advance;
    }
  }
  return advance;
}

/// The largest of the three proven advances: by speed, along the closest direction, along
/// that direction turning.
template <PairKind K, class T>
BB_HD inline T proven_advance(const Mat<T, 3, pair_points(K)>& x, const Mat<T, 3, pair_points(K)>& dx,
                              const Closest<T, pair_points(K)>& closest, T by_speed, T level) {
  const Vec<T, 3> n = closest.r / closest.d, still = Vec<T, 3>::Zero();
  const Vec<T, 3> turn = turn_of_normal<T, pair_points(K)>(x, dx, n, closest.region);
  const T fixed = directional_advance<K, T>(x, dx, n, still, level);
  const T turning = directional_advance<K, T>(x, dx, n, turn, level);
  const T directional = fixed > turning ? fixed : turning;
  return by_speed > directional ? by_speed : directional;
}

}  // namespace detail

/// Conservative advance of one pair along x0 + t (x1 - x0), t in [0, 1].
/// Each advance is the larger of the speed bound and the directional bound. The stop level of the gap d -
/// offset is max(park, 16 ulps of the largest coordinate), half the start gap for a pair that starts below
/// twice that.
/// @param x0, x1  [3 x N] points at t = 0 and 1 in the order of pair.hpp, m
/// @param offset  thickness, m: the gap is d - offset; >= 0
/// @param park    where an approaching pair is stopped, m; 0: the ulp floor alone
/// @param max_probes  bound on the work of one query; reached only by pairs that slide just above the stop
/// level
/// @param enough  the pair is given up, without a hit, at the first proven time above it: toi is then that time
/// @param computed_from  largest |coordinate| of what x0 and x1 were computed from with a few roundings, m; 0: they are
/// given
/// @return toi > 0 unless the pair starts below the ulp floor; at toi the gap is at least the stop level
/// Errors: none; a motion that is not finite (or whose squares are not), an offset or a stop level that is NaN, give hit
/// and toi 0: only what is proven is free.
/// Host-device.   Cost: 1 to 5 probes are usual; no allocation.
/// Source: Li, Kaufman, Jiang 2021 (codimensional IPC), section 4 for the speed bound over all of a pair; the
/// directional bound as in Ando's contact solver (2024, ppf-contact-solver).
template <PairKind K, class T>
BB_HD inline AccdResult<T> accd(const Mat<T, 3, pair_points(K)>& x0, const Mat<T, 3, pair_points(K)>& x1,
                                T offset, T park, int max_probes = 4096, T enough = T(1),
                                T computed_from = T(0)) {
  constexpr int N = pair_points(K);
  constexpr T eps = std::numeric_limits<T>::epsilon();
  const detail::CentredMotion<T, N> motion = detail::centre_motion<T, N>(x0, x1, offset, computed_from);
  // Centring, the motion and the distance each round by about an ulp of the local size in every coordinate.
  const T rounding = 4 * eps * motion.local;
  const T ulp_floor = 16 * eps * motion.largest;
  const T extent = motion.x.squaredNorm() + motion.dx.squaredNorm();
  if (!(extent < std::numeric_limits<T>::infinity()) || park != park) return {T(0), true, 0, false, false};
  const T speed = detail::relative_speed<K, T>(motion.dx) * (1 + 4 * eps);

  T t = 0, level = 0;
  for (int probe = 1; probe <= max_probes; ++probe) {
    const Mat<T, 3, N> x = motion.x + t * motion.dx;
    const Closest<T, N> closest = closest_points<K, T>(x);
    const T gap = closest.d - offset;
    if (probe == 1) {
      if (!(gap > 0)) return {T(0), true, probe, false, true};
      if (!(gap > ulp_floor)) return {T(0), true, probe, false, false};
      const T stop = park > ulp_floor ? park : ulp_floor;
      level = (gap < 2 * stop ? gap / 2 : stop) + rounding;
      if (speed == 0) return {T(1), false, probe, false, false};
    }
    const T room = gap - level;
    // Below rounding of the level there is nothing left to prove: t is where the pair stops.
    if (probe > 1 && !(room > rounding)) return {t, true, probe, false, false};
    const T advance =
        detail::proven_advance<K, T>(x, motion.dx, closest, room / speed, level + offset) * (1 - 4 * eps);
    if (advance > 1 - t) return {T(1), false, probe, false, false};
    const T next = t + advance;
    if (!(next > t)) return {t, true, probe, false, false};
    t = next;
    if (t > enough) return {t, false, probe, false, false};
  }
  return {t, true, max_probes, true, false};
}

}  // namespace bb
