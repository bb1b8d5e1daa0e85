// True clamped closest points of point-point, point-edge, point-triangle and edge-edge pairs in 3D: right for
// obtuse, thin and zero-area triangles, parallel and zero-length edges. What a contact is made of: weights,
// vector, distance, region. Derivatives are in distance_derivatives.hpp.
#pragma once

#include <cmath>
#include <limits>

#include "core/geometry/pair.hpp"
#include "core/geometry/region.hpp"
#include "core/math/products.hpp"
#include "core/math/types.hpp"

namespace bb {

/// Closest points of a pair: r = sum_i weights_i x_i points from the second primitive to the first.
template <class T, int N>
struct Closest {
  Vec<T, N> weights;  // order of the points; first primitive >= 0, sum 1; second <= 0, sum -1
  Vec<T, 3> r;        // m
  T d;                // |r|, m, without any offset
  Region region;      // the features that carry the closest points; in ties any closest pair
};

namespace detail {

/// Closest point e0 + t (e1 - e0) of a segment to the point e0 + q; u = e1 - e0.
template <class T>
struct SegmentFoot {
  T t;          // in [0, 1]
  int feature;  // 0: e0, 1: e1, 2: between
  Vec<T, 3> r;  // q - t u
};

/// The vector r is accurate relative to its own length, however close q is to the segment: its direction is
/// what a step bound and a contact normal depend on.
template <class T>
BB_HD inline SegmentFoot<T> segment_foot(const Vec<T, 3>& q, const Vec<T, 3>& u) {
  const T uu = u.squaredNorm(), qu = q.dot(u);
  const Vec<T, 3> from_end = q - u;
  if (!(uu > 0) || !(qu > 0)) return {T(0), 0, q};
  if (!(from_end.dot(u) < 0)) return {T(1), 1, from_end};
  const T t = qu / uu;
  const Vec<T, 3> normal = accurate_cross(u, q);
  return {t < 1 ? t : T(1), 2, accurate_cross(normal, u) / uu};
}

/// Least |r0 + s e + t f| over all s, t.
template <class T>
struct PlaneFoot {
  bool found;   // false when e and f are parallel to the last bit
  bool clear;   // e and f are at least 1e-3 rad from parallel: an interior foot needs no rival
  T s, t;       // not clamped
  Vec<T, 3> r;  // r0 + s e + t f, along the common normal
};

/// By cross products, whose conditioning is 1/sin of the angle and not its square, corrected until what is
/// left in the plane of e and f is rounding.
template <class T>
BB_HD inline PlaneFoot<T> plane_foot(const Vec<T, 3>& r0, const Vec<T, 3>& e, const Vec<T, 3>& f) {
  using std::abs;
  constexpr T eps = std::numeric_limits<T>::epsilon();
  constexpr int max_corrections = 4;
  const Vec<T, 3> n = accurate_cross(e, f);
  const T nn = n.squaredNorm();
  if (!(nn > 0)) return {false, false, T(0), T(0), r0};

  PlaneFoot<T> foot{true, nn > T(1e-6) * e.squaredNorm() * f.squaredNorm(), T(0), T(0), r0};
  const T size_sq = r0.squaredNorm();
  for (int k = 0; k < max_corrections; ++k) {
    const T s = -n.dot(accurate_cross(foot.r, f)) / nn, t = -n.dot(accurate_cross(e, foot.r)) / nn;
    foot.s += s;
    foot.t += t;
    foot.r = r0 + foot.s * e + foot.t * f;
    if ((s * e + t * f).squaredNorm() <= 16 * eps * eps * size_sq) break;
  }
  return foot;
}

/// The part of the realised vector r along e x f, where that direction is known better than r is: the
/// rounding of r turns it by eps size/|r|, that of the normal by eps/sin(e, f).
template <class T>
BB_HD inline Vec<T, 3> along_normal(const Vec<T, 3>& r, const Vec<T, 3>& e, const Vec<T, 3>& f) {
  using std::sqrt;
  const Vec<T, 3> n = accurate_cross(e, f);
  const T ee = e.squaredNorm(), ff = f.squaredNorm(), nn = n.squaredNorm();
  const T size_sq = ee > ff ? ee : ff;
  if (!(nn * size_sq > r.squaredNorm() * ee * ff)) return r;
  return n * (n.dot(r) / nn);
}

}  // namespace detail

/// Point-point. @param x [3 x 2] p q, m.   Host-device, no allocation; as every overload below.
template <class T>
BB_HD inline Closest<T, 2> closest_point_point(const Mat<T, 3, 2>& x) {
  Closest<T, 2> out;
  out.weights << T(1), T(-1);
  out.r = x.col(0) - x.col(1);
  out.d = out.r.norm();
  out.region = Region::p_p;
  return out;
}

/// Point-edge. @param x [3 x 3] p e0 e1, m; a zero-length edge is the point e0.
template <class T>
BB_HD inline Closest<T, 3> closest_point_edge(const Mat<T, 3, 3>& x) {
  const Vec<T, 3> q = x.col(0) - x.col(1), u = x.col(2) - x.col(1);
  const detail::SegmentFoot<T> foot = detail::segment_foot(q, u);
  constexpr Region regions[] = {Region::p_e0, Region::p_e1, Region::p_e};
  Closest<T, 3> out;
  out.weights << T(1), foot.t - 1, 0 - foot.t;
  out.r = foot.feature == 1 ? Vec<T, 3>(x.col(0) - x.col(2)) : foot.r;
  out.d = out.r.norm();
  out.region = regions[foot.feature];
  return out;
}

namespace detail {

/// Keeps the candidate (a first-primitive point against an edge, or the reverse) when it is closer.
template <class T>
BB_HD inline void keep_closer(Closest<T, 4>& best, int point, int e0, int e1, T sign, const Mat<T, 3, 4>& x,
                              const Region (&regions)[3]) {
  const Vec<T, 3> q = x.col(point) - x.col(e0), u = x.col(e1) - x.col(e0);
  const SegmentFoot<T> foot = segment_foot(q, u);
  const Vec<T, 3> r = foot.feature == 1 ? Vec<T, 3>(x.col(point) - x.col(e1)) : foot.r;
  const T d = r.norm();
  if (!(d < best.d)) return;
  best.weights.setZero();
  best.weights[point] = sign;
  best.weights[e0] = sign * foot.t - sign;
  best.weights[e1] = 0 - sign * foot.t;  // never -0
  best.r = sign * r;
  best.d = d;
  best.region = regions[foot.feature];
}

}  // namespace detail

/// Point-triangle. @param x [3 x 4] p t0 t1 t2, m; any triangle, zero area included.
/// The interior solution is compared with the three clamped edges where its plane is uncertain; the
/// smallest realised distance wins. Source: candidate scan and cross products as in the contact solver of
/// Ando 2024 (ppf-contact-solver).
template <class T>
BB_HD inline Closest<T, 4> closest_point_triangle(const Mat<T, 3, 4>& x) {
  const T edge_sq[3] = {(x.col(3) - x.col(2)).squaredNorm(), (x.col(1) - x.col(3)).squaredNorm(),
                        (x.col(2) - x.col(1)).squaredNorm()};
  // Measured from the corner opposite to the longest edge: its two edges have the least rounding.
  int k = edge_sq[1] > edge_sq[0] ? 1 : 0;
  if (edge_sq[2] > edge_sq[k]) k = 2;
  const int a = 1 + k, b = 1 + (k + 1) % 3, c = 1 + (k + 2) % 3;

  Closest<T, 4> best;
  best.weights.setZero();
  best.r = x.rowwise().sum();  // kept only when nothing is comparable: x is not finite
  best.d = std::numeric_limits<T>::infinity();
  best.region = Region::p_t0;
  const Vec<T, 3> q = x.col(0) - x.col(a), e = x.col(b) - x.col(a), f = x.col(c) - x.col(a);
  const detail::PlaneFoot<T> foot = detail::plane_foot<T>(q, e, f);
  const T wb = -foot.s, wc = -foot.t, wa = 1 - wb - wc;
  if (foot.found && wa > 0 && wb > 0 && wc > 0) {
    best.weights[0] = 1;
    best.weights[a] = -wa;
    best.weights[b] = -wb;
    best.weights[c] = -wc;
    best.r = detail::along_normal<T>(foot.r, e, f);
    best.d = foot.r.norm();
    best.region = Region::p_t;
    if (foot.clear) {
      best.d = best.r.norm();
      return best;
    }
  }
  constexpr Region edge01[] = {Region::p_t0, Region::p_t1, Region::p_e01};
  constexpr Region edge12[] = {Region::p_t1, Region::p_t2, Region::p_e12};
  constexpr Region edge20[] = {Region::p_t2, Region::p_t0, Region::p_e20};
  detail::keep_closer(best, 0, 1, 2, T(1), x, edge01);
  detail::keep_closer(best, 0, 2, 3, T(1), x, edge12);
  detail::keep_closer(best, 0, 3, 1, T(1), x, edge20);
  best.d = best.r.norm();
  return best;
}

/// Edge-edge. @param x [3 x 4] ea0 ea1 eb0 eb1, m; any edges, parallel and zero-length ones included.
/// The interior solution is compared with the four clamped end points where its plane is uncertain; the
/// smallest realised distance wins.
template <class T>
BB_HD inline Closest<T, 4> closest_edge_edge(const Mat<T, 3, 4>& x) {
  Closest<T, 4> best;
  best.weights.setZero();
  best.r = x.rowwise().sum();  // kept only when nothing is comparable: x is not finite
  best.d = std::numeric_limits<T>::infinity();
  best.region = Region::ea0_eb0;
  const Vec<T, 3> q = x.col(0) - x.col(2), u = x.col(1) - x.col(0), v = x.col(3) - x.col(2);
  const detail::PlaneFoot<T> foot = detail::plane_foot<T>(q, u, v);
  const T wa = foot.s, wb = -foot.t;
  if (foot.found && wa > 0 && wa < 1 && wb > 0 && wb < 1) {
    best.weights << 1 - wa, wa, wb - 1, -wb;
    best.r = detail::along_normal<T>(foot.r, u, v);
    best.d = foot.r.norm();
    best.region = Region::ea_eb;
    if (foot.clear) {
      best.d = best.r.norm();
      return best;
    }
  }
  constexpr Region a0[] = {Region::ea0_eb0, Region::ea0_eb1, Region::ea0_eb};
  constexpr Region a1[] = {Region::ea1_eb0, Region::ea1_eb1, Region::ea1_eb};
  constexpr Region b0[] = {Region::ea0_eb0, Region::ea1_eb0, Region::ea_eb0};
  constexpr Region b1[] = {Region::ea0_eb1, Region::ea1_eb1, Region::ea_eb1};
  detail::keep_closer(best, 0, 2, 3, T(1), x, a0);
  detail::keep_closer(best, 1, 2, 3, T(1), x, a1);
  detail::keep_closer(best, 2, 0, 1, T(-1), x, b0);
  detail::keep_closer(best, 3, 0, 1, T(-1), x, b1);
  best.d = best.r.norm();
  return best;
}

/// Closest points of a pair of kind K. @param x [3 x N] its points in the order of pair.hpp, m.
/// Errors: none for finite x; what a non-finite x gives means nothing.
/// Accuracy: d and r to a few eps of the pair's size (not of its distance from the origin); the direction of
/// r to a few eps on points and edges, eps/sin of the two edges' angle in interior regions.
template <PairKind K, class T>
BB_HD inline Closest<T, pair_points(K)> closest_points(const Mat<T, 3, pair_points(K)>& x) {
  if constexpr (K == PairKind::point_point) return closest_point_point<T>(x);
  if constexpr (K == PairKind::point_edge) return closest_point_edge<T>(x);
  if constexpr (K == PairKind::point_triangle) return closest_point_triangle<T>(x);
  if constexpr (K == PairKind::edge_edge) return closest_edge_edge<T>(x);
}

}  // namespace bb
