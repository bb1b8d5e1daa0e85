// The local frame of a row whose closest points slide along edges, from what a row keeps of them. Host-device, no allocation.
#pragma once

#include "core/contact/contact_table.hpp"
#include "core/contact/pair_geometry.hpp"
#include "core/contact/row_hessian.hpp"
#include "core/geometry/distance_derivatives.hpp"

namespace bb {

/// Edges along which the closest points of a row slide.
BB_HD constexpr int n_sliding(ContactKind kind) {
  if (kind == ContactKind::point_edge || kind == ContactKind::obstacle_edge) return 1;
  const bool two = kind == ContactKind::point_triangle || kind == ContactKind::edge_edge ||
                   kind == ContactKind::obstacle_triangle;
  return two ? 2 : 0;
}

/// Vertices in role order.
template <class T>
struct SlidingRow {
  ContactKind kind;
  unsigned free;     // bit k: vertex k is free
  Vec<T, 4> weight;  // w_i
  Vec<T, 3> normal;  // unit
  T distance;        // of the closest points; of an obstacle from its centre or its axis, m
  T stiffness, force;
};

namespace detail {

/// The rest of a shape that has a frame; given points are 0.
template <class T, int F>
BB_HD void complete(const SlidingRow<T>& row, RowShape<T, F>& shape) {
  for (int k = 0; k < 4; ++k) {
    const bool is_free = (row.free >> k & 1) != 0;
    shape.w[k] = is_free ? row.weight[k] : T(0);
    for (int l = 0; l < F && !is_free; ++l) shape.g[l][k] = T(0);
  }
  shape.distance = row.distance;
  shape.stiffness = row.stiffness;
  shape.force = row.force;
}

/// Of the insides of the primitives of a pair.
template <PairKind K, class T>
BB_HD RowShape<T, K == PairKind::point_edge ? 1 : 2> pair_shape(const SlidingRow<T>& row,
                                                                const Mat<T, 3, pair_points(K)>& points) {
  constexpr int n = pair_points(K), F = K == PairKind::point_edge ? 1 : 2;
  Closest<T, n> closest;
  for (int k = 0; k < n; ++k) closest.weights[k] = row.weight[k];
  closest.d = row.distance;
  closest.r = row.distance * row.normal;
  closest.region = K == PairKind::point_edge       ? Region::p_e
                   : K == PairKind::point_triangle ? Region::p_t
                                                   : Region::ea_eb;
  const auto frame = region_frame<T, n>(points, closest);
  RowShape<T, F> out;
  out.n = frame.n;
  for (int l = 0; l < F; ++l) {
    out.q[l] = frame.q[l];
    out.g[l].setZero();
    for (int k = 0; k < n; ++k) out.g[l][k] = frame.g[l][k];
  }
  complete(row, out);
  return out;
}

/// Of an obstacle and the inside of an edge (N = 2) or a triangle. axis: of a cylinder, unit; 0: a sphere.
template <int N, class T>
BB_HD RowShape<T, N - 1> obstacle_shape(const SlidingRow<T>& row, const Mat<T, 3, N>& x,
                                        const Vec<T, 3>& axis) {
  // The frame is made of differences of vertices: where the centre is does not count.
  Mat<T, 3, N + 1> points;
  points.col(0).setZero();
  for (int k = 0; k < N; ++k) {
    const Vec<T, 3> from_first = x.col(k) - x.col(0);
    points.col(k + 1) = from_first - axis.dot(from_first) * axis;
  }
  Closest<T, N + 1> closest;
  closest.weights.setZero();
  closest.d = row.distance;
  closest.r = row.distance * row.normal;
  closest.region = N == 2 ? Region::p_e : Region::p_t;
  const auto frame = region_frame<T, N + 1>(points, closest);
  RowShape<T, N - 1> out;
  out.n = frame.n;
  for (int l = 0; l < N - 1; ++l) {
    out.q[l] = frame.q[l];
    out.g[l].setZero();
    for (int k = 0; k < N; ++k) out.g[l][k] = frame.g[l][k + 1];
  }
  out.bend = axis.squaredNorm() > 0 ? T(0) : T(1);
  complete(row, out);
  return out;
}

}  // namespace detail

/// f(the shape of the row), where its closest points slide; in role order, given points 0.
/// @param points  points.template first<N>() are the first N vertices of the row, m
/// @param axis    of a cylinder, unit; 0 of all others
template <class T, class Points, class F>
BB_HD void with_sliding_shape(const SlidingRow<T>& row, const Points& points, const Vec<T, 3>& axis,
                              const F& f) {
  switch (row.kind) {
    case ContactKind::point_edge:
      return f(detail::pair_shape<PairKind::point_edge, T>(row, points.template first<3>()));
    case ContactKind::point_triangle:
      return f(detail::pair_shape<PairKind::point_triangle, T>(row, points.template first<4>()));
    case ContactKind::edge_edge:
      return f(detail::pair_shape<PairKind::edge_edge, T>(row, points.template first<4>()));
    case ContactKind::obstacle_edge:
      return f(detail::obstacle_shape<2, T>(row, points.template first<2>(), axis));
    case ContactKind::obstacle_triangle:
      return f(detail::obstacle_shape<3, T>(row, points.template first<3>(), axis));
    default:
      return;
  }
}

/// The free points moved to the front, in order; 0 behind them.
template <class T, int F>
BB_HD void move_to_front(unsigned free, RowShape<T, F>& shape) {
  int slot = 0;
  for (int k = 0; k < 4; ++k) {
    if ((free >> k & 1) == 0) continue;
    shape.w[slot] = shape.w[k];
    for (int l = 0; l < F; ++l) shape.g[l][slot] = shape.g[l][k];
    ++slot;
  }
  for (; slot < 4; ++slot) {
    shape.w[slot] = T(0);
    for (int l = 0; l < F; ++l) shape.g[l][slot] = T(0);
  }
}
/// The same of a 12 x 12 matrix.
template <class T>
BB_HD Mat<T, 12, 12> moved_to_front(unsigned free, const Mat<T, 12, 12>& full) {
  int local[4], n = 0;
  for (int k = 0; k < 4; ++k) {
    if ((free >> k & 1) != 0) local[n++] = k;
  }
  Mat<T, 12, 12> out = Mat<T, 12, 12>::Zero();
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      out.template block<3, 3>(3 * i, 3 * j) = full.template block<3, 3>(3 * local[i], 3 * local[j]);
    }
  }
  return out;
}

}  // namespace bb
