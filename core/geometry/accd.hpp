// Additive continuous collision detection of ONE pair: how far it may move along straight vertex paths before
// its gap falls to a stop level. Every advance is proven; nothing is extrapolated. One code for float and
// double.
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
  bool hit;               // false: all of [0, 1] is proven to stay above the stop level
  int probes;             // closest-point evaluations
  bool capped;            // stopped by max_probes: toi is the last proven time
  bool overlap_at_start;  // gap <= 0 at time 0 (or not a number); then toi = 0
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
BB_HD inline CentredMotion<T, N> centre_motion(const Mat<T, 3, N>& x0, const Mat<T, 3, N>& x1, T offset) {
  CentredMotion<T, N> m;
  m.x = x0.colwise() - Vec<T, 3>(x0.rowwise().mean());
  m.dx = x1 - x0;
  const Vec<T, 3> drift = m.dx.rowwise().mean();
  m.dx = m.dx.colwise() - drift;
  const T at0 = x0.cwiseAbs().maxCoeff(), at1 = x1.cwiseAbs().maxCoeff();
  m.largest = at0 > at1 ? at0 : at1;
  m.largest = m.largest > offset ? m.largest : offset;
  const T local0 = m.x.cwiseAbs().maxCoeff(), local1 = (m.x + m.dx).cwiseAbs().maxCoeff();
  m.local = local0 > local1 ? local0 : local1;
  m.local = m.local > offset ? m.local : offset;
  return m;
}

/// Largest relative displacement of a vertex of one primitive against a vertex of the other: the gap of two
/// points of the primitives cannot change faster.
template <PairKind K, class T>
BB_HD inline T relative_speed(const Mat<T, 3, pair_points(K)>& dx) {
  using std::sqrt;
  T speed_sq = 0;
  for (int i = 0; i < pair_split(K); ++i) {
    for (int j = pair_split(K); j < pair_points(K); ++j) {
      const T s = (dx.col(i) - dx.col(j)).squaredNorm();
      speed_sq = speed_sq > s ? speed_sq : s;
    }
  }
  return sqrt(speed_sq);
}

/// Time from now until the gap along the fixed unit direction n may fall below `level`; 0 when it proves
/// nothing. The gap of the primitives is at least the least n . (x_i - x_j) over their vertices, each affine
/// in time, so the first crossing is known exactly. Infinite when none of them falls.
template <PairKind K, class T>
BB_HD inline T directional_advance(const Mat<T, 3, pair_points(K)>& x, const Mat<T, 3, pair_points(K)>& dx,
                                   const Vec<T, 3>& n, T level) {
  T advance = std::numeric_limits<T>::infinity();
  for (int i = 0; i < pair_split(K); ++i) {
    for (int j = pair_split(K); j < pair_points(K); ++j) {
      const T room = n.dot(x.col(i) - x.col(j)) - level;
      const T rate = n.dot(dx.col(i) - dx.col(j));
      if (!(room > 0)) return T(0);
      if (rate < 0 && room < -rate * advance) advance = room / -rate;
    }
  }
  return advance;
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
/// @return toi > 0 unless the pair starts below the ulp floor; at toi the gap is at least the stop level
/// Errors: none; a start or motion that is not finite gives hit, toi 0 or the last proven time.
/// Host-device.   Cost: 1 to 5 probes are usual; no allocation.
/// Source: Li, Kaufman, Jiang 2021 (codimensional IPC), section 4 for the speed bound over all of a pair; the
/// directional bound as in Ando's contact solver (2024, ppf-contact-solver).
template <PairKind K, class T>
BB_HD inline AccdResult<T> accd(const Mat<T, 3, pair_points(K)>& x0, const Mat<T, 3, pair_points(K)>& x1,
                                T offset, T park, int max_probes = 4096) {
  constexpr int N = pair_points(K);
  constexpr T eps = std::numeric_limits<T>::epsilon();
  const detail::CentredMotion<T, N> motion = detail::centre_motion<T, N>(x0, x1, offset);
  // Centring, the motion and the distance each round by about an ulp of the local size in every coordinate.
  const T rounding = 4 * eps * motion.local;
  const T ulp_floor = 16 * eps * motion.largest;
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
    }
    const T room = gap - level;
    // Below rounding of the level there is nothing left to prove: t is where the pair stops.
    if (!(room > rounding)) {
      if (!(speed > 0)) return {T(1), false, probe, false, false};
      if (probe > 1) return {t, true, probe, false, false};
    }
    const T by_speed = speed > 0 ? room / speed : std::numeric_limits<T>::infinity();
    const Vec<T, 3> n = closest.r / closest.d;
    const T by_direction = detail::directional_advance<K, T>(x, motion.dx, n, level + offset);
    const T advance = (by_speed > by_direction ? by_speed : by_direction) * (1 - 4 * eps);
    const T remaining = 1 - t;
    if (advance > remaining) return {T(1), false, probe, false, false};
    const T next = t + advance;
    if (!(next > t)) return {t, true, probe, false, false};
    t = next;
  }
  return {t, true, max_probes, true, false};
}

}  // namespace bb
