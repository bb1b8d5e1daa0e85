// Edges and triangles outside a sphere or a cylinder: which of them make pairs, their candidates, rows and times.
// Such a pair is that of its primitive with a point which is given: the centre, or in the plane across a cylinder's axis
// the point where the axis crosses it. An obstacle that moves has a pose at either end of a motion, `s` and `end`, and
// goes straight between them. Host-device, no allocation.
#pragma once

#include "core/contact/obstacle_motion.hpp"
#include "core/contact/pair_planes.hpp"
#include "core/contact/pair_row.hpp"
#include "core/geometry/accd.hpp"

namespace bb {

/// The pair of a primitive with N vertices and a point.
template <int N>
constexpr PairKind centre_pair = N == 1   ? PairKind::point_point
                                 : N == 2 ? PairKind::point_edge
                                          : PairKind::point_triangle;
/// Its kind in a PairId, its place behind the lists of PairKind, and that of a row on the inside of the primitive.
template <int N>
constexpr int obstacle_pairs_of = obstacle_pairs + N - 1;

/// The allowed side is convex: what the vertices of a primitive keep to, all of it keeps to.
template <class T>
BB_HD bool is_convex(const AnalyticSurface<T>& s) {
  return s.inside || s.kind == ObstacleKind::plane;
}

/// Edges may run along the axis: then vertices carry what the mollified edges do not. In a planar scene a cylinder
/// that stands on the plane is a disk.
template <class T>
BB_HD bool is_line(const AnalyticSurface<T>& s, bool planar) {
  return s.kind == ObstacleKind::cylinder && !(planar && s.axis[2] * s.axis[2] > T(0.25));
}

/// Whether primitives with N vertices make pairs with the obstacle. A ball or a disk pairs with what is no part of a
/// larger primitive: the closest point of that is the closest of all. The closest point of a triangle to a line that
/// does not cross it is on its sides.
template <int N, class T>
BB_HD bool pairs_with(const AnalyticSurface<T>& s, bool planar, bool lone) {
  if (N == 1) return is_convex(s) || is_line(s, planar) || lone;
  if (N == 2) return !is_convex(s) && (is_line(s, planar) || lone);
  return !is_convex(s) && !is_line(s, planar);
}

/// The points of that pair, m: 0, then the vertices from the centre, of a cylinder across its axis.
template <int N, class T>
BB_HD Mat<T, 3, N + 1> about_centre(const AnalyticSurface<T>& s, const Mat<T, 3, N>& x) {
  Mat<T, 3, N + 1> out;
  out.col(0).setZero();
  for (int k = 0; k < N; ++k) {
    out.col(k + 1) = detail::radial_part<T>(s, Vec<T, 3>(x.col(k) - s.point));
  }
  return out;
}

/// Whether a primitive may come within `reach` (m) of the obstacle on x0 -> x1. The gap of a point falls by at most the
/// way gone relative to the obstacle, and from the middle of a primitive to its farthest vertex by at most their distance: a bound for any
/// obstacle; 1e-12 covers rounding.
template <int N>
BB_HD bool may_reach(const AnalyticSurface<double>& s, const AnalyticSurface<double>& end,
                     const Mat<double, 3, N>& x0, const Mat<double, 3, N>& x1, double reach) {
  using std::sqrt;
  const Vec3d moved = end.point - s.point;
  Vec3d middle = x0.col(0);
  for (int k = 1; k < N; ++k) middle += (x0.col(k) - x0.col(0)) / N;
  double extent_sq = 0, way_sq = 0, all = 0;
  for (int k = 0; k < N; ++k) {
    const double e = (x0.col(k) - middle).squaredNorm(), w = (x1.col(k) - x0.col(k) - moved).squaredNorm();
    extent_sq = e > extent_sq ? e : extent_sq;
    way_sq = w > way_sq ? w : way_sq;
    all += e + w;
  }
  if (!(all < std::numeric_limits<double>::infinity())) return true;
  const double start = surface_gap<double>(s, middle).d, fall = sqrt(extent_sq) + sqrt(way_sq);
  return !(start - fall - 1e-12 * ((start < 0 ? -start : start) + fall) > reach);
}

/// Whether a plane proves the pair farther apart than `reach` beyond the radius, m.
template <int N>
BB_HD bool far_from_centre(const AnalyticSurface<double>& s, const Mat<double, 3, N + 1>& points,
                           double reach) {
  return farther_than<centre_pair<N>>(points, s.radius + reach);
}

/// The row of a vertex over an obstacle. offset: thickness, m.
template <class T>
BB_HD PairRow obstacle_row(int vertex, const SurfaceGap<T>& gap, T offset) {
  return {ContactKind::obstacle,
          {vertex, -1, -1, -1},
          {1, 0, 0, 0},
          gap.normal.template cast<double>(),
          static_cast<double>(gap.d - offset)};
}

/// The row of a pair, on the vertices of the feature that is closest; the normal points away from the centre.
/// offset: thickness, m.
template <int N, class T>
BB_HD PairRow obstacle_row(const int* vertex, const Closest<T, N + 1>& closest, T radius, T offset) {
  int with_centre[N + 1];
  with_centre[0] = -2;  // below every vertex: it stays in front
  for (int k = 0; k < N; ++k) with_centre[k + 1] = vertex[k];
  PairRow row = pair_row<T>(with_centre, closest.weights.data(), closest.r, closest.d, closest.region, 0.0);
  int n = 0;
  for (int k = 0; k < 3; ++k) {
    const bool used = row.stencil[k + 1] >= 0;
    n += used ? 1 : 0;
    row.stencil[k] = used ? row.stencil[k + 1] : -1;
    row.weight[k] = used ? -row.weight[k + 1] : 0;
  }
  row.stencil[3] = -1;
  row.weight[3] = 0;
  row.normal = -row.normal;
  row.kind = n == 1   ? ContactKind::obstacle
             : n == 2 ? ContactKind::obstacle_edge
                      : ContactKind::obstacle_triangle;
  row.d = closest.d - radius - offset;
  return row;
}

/// A mollified row of an edge with the axis keeps both ends, whatever is closest.
template <class T>
BB_HD Closest<T, 3> on_whole_edge(Closest<T, 3> closest) {
  closest.region = Region::p_e;
  return closest;
}

/// What the obstacle itself adds to the least stop level of queries in the scalar T: twice 16 ulps of its size, m.
template <class T>
BB_HD double stop_floor(const AnalyticSurface<double>& s, const AnalyticSurface<double>& end) {
  const double first = s.point.cwiseAbs().maxCoeff(), last = end.point.cwiseAbs().maxCoeff();
  const double at = first > last ? first : last;
  return 32 * static_cast<double>(std::numeric_limits<T>::epsilon()) * (at > s.radius ? at : s.radius);
}

/// A time before which the pair is proven to stay above its stop level; no better than needed to be above `enough`.
/// T: the scalar of the query; what is proven is in double. stop: stop level as far as it is that of the motion, m.
template <int N, class T>
BB_HD double obstacle_proven_time(const AnalyticSurface<double>& s, const AnalyticSurface<double>& end,
                                  const Mat<double, 3, N>& x0, const Mat<double, 3, N>& x1, double offset,
                                  double stop, double enough) {
  constexpr PairKind K = centre_pair<N>;
  const double own = stop_floor<T>(s, end);
  double reach = offset + 2 * (stop > own ? stop : own);
  // across an axis is a difference of lengths that may be larger than what is left
  for (int k = 0; k < N; ++k)
    reach += 1e-12 * ((x0.col(k) - s.point).norm() + (x1.col(k) - end.point).norm());
  const Mat<double, 3, N + 1> from = about_centre<N, double>(s, x0), to = about_centre<N, double>(end, x1);
  PairLanes<K, double> points, motion;
  for (int k = 0; k <= N; ++k) {
    for (int c = 0; c < 3; ++c) {
      points.x[k][c] = from(c, k);
      motion.x[k][c] = to(c, k) - from(c, k);
    }
  }
  return proven_times<K, double>(points, motion, s.radius + reach, enough);
}

/// accd() of a primitive and the obstacle.
template <int N, class T>
BB_HD AccdResult<T> obstacle_accd(const AnalyticSurface<T>& s, const AnalyticSurface<T>& end,
                                  const Mat<T, 3, N>& x0, const Mat<T, 3, N>& x1, T offset, T park,
                                  int max_probes, T enough) {
  const T sizes[] = {x1.cwiseAbs().maxCoeff(), s.point.cwiseAbs().maxCoeff(),
                     end.point.cwiseAbs().maxCoeff()};
  T largest = x0.cwiseAbs().maxCoeff();
  for (const T size : sizes) largest = largest < size ? size : largest;
  return accd<centre_pair<N>, T>(about_centre<N, T>(s, x0), about_centre<N, T>(end, x1), offset + s.radius,
                                 park, max_probes, enough, largest);
}

}  // namespace bb
