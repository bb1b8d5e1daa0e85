// Hessians of rows that are made of more than one normal: mollified rows, and in mode projected_full those whose
// closest points slide along edges.
#pragma once

#include "core/contact/contact_terms.hpp"
#include "core/contact/executor/executor_pair.hpp"
#include "core/contact/executor/executor_rows.hpp"
#include "core/contact/mollified_terms.hpp"
#include "core/contact/obstacle.hpp"
#include "core/contact/obstacle_pair.hpp"
#include "core/contact/row_hessian.hpp"
#include "core/contact/sliding_shape.hpp"
#include "core/linear/executor/find_block.hpp"

namespace bb::exec {

/// Which Hessian of a row goes into the matrix: exact + t (clamped - exact), or the projection of one kind; the clamped one where a
/// free vertex of the row has a force of at least `threshold`.
struct HessianChoice {
  HessianMode mode = HessianMode::gauss_newton;
  Projection projection = Projection::psd;
  bool blended = false;  // then projection is not read, and no force
  double t = 1;
  double threshold = -1;          // N; below 0: no vertex is compared
  const double* force = nullptr;  // [n_vertices] N, read where there is a threshold

  BB_HD Projection projection_of(const RowView& rows, Index r) const {
    bool clamps = blended;
    for (int k = 0; k < 4 && threshold >= 0 && !clamps; ++k) {
      clamps = rows.is_free(r, k) && force[rows.vertex[k * rows.n + r]] >= threshold;
    }
    return clamps ? Projection::psd : projection;
  }
};

/// Numbers of a row's lower blocks, lower_block(4, a, b), at number[c * stride + row].
constexpr int row_numbers = static_cast<int>(n_lower_numbers(4));

BB_HD inline double blend(double exact, double clamped, double t) { return exact + t * (clamped - exact); }

BB_HD inline Vec<double, 4> weights_of(const RowView& rows, Index r) {
  return Vec<double, 4>(rows.weight[r], rows.weight[rows.n + r], rows.weight[2 * rows.n + r],
                        rows.weight[3 * rows.n + r]);
}

/// The first N vertices of a row, m.
template <int N>
BB_HD Mat<double, 3, N> leading_points(const RowView& rows, Index r, const double* x) {
  int vertex[N];
  for (int k = 0; k < N; ++k) vertex[k] = rows.vertex[k * rows.n + r];
  return points_of<N>(x, vertex);
}

/// Offset of a pair that is not one with an obstacle, m.
BB_HD inline double pair_offset(const SurfaceView& s, Key pair) {
  const int i = pair_first(pair), j = pair_second(pair);
  switch (static_cast<PairKind>(pair_list(pair))) {
    case PairKind::point_point:
      return s.points.offset[i] + s.points.offset[j];
    case PairKind::point_edge:
      return s.points.offset[i] + s.edges.offset[j];
    case PairKind::point_triangle:
      return s.points.offset[i] + s.triangles.offset[j];
    case PairKind::edge_edge:
      break;
  }
  return s.edges.offset[i] + s.edges.offset[j];
}

/// The obstacle of a row that has one, where it is in the state x.
BB_HD inline AnalyticSurface<double> obstacle_of(const SurfaceView& s, Key pair, const double* x) {
  return s.obstacles[pair_second(pair)].surface(x);
}

/// Whether a mollified row is one of an edge and the axis of a cylinder.
BB_HD inline bool of_axis(const RowView& rows, Index r) {
  return pair_list(rows.pair[r]) == obstacle_pairs_of<2>;
}

/// Value and derivatives of a mollified row at a state.
struct MollifiedRowAt {
  RowView rows;
  SurfaceView surface;
  const double* x;

  BB_HD MollifiedDerivatives<double> derivatives(Index r) const {
    const double b = rows.energy[r], db = rows.force[r], d2b = rows.stiffness[r];
    if (!of_axis(rows, r)) {
      return mollified_derivatives<double>(leading_points<4>(rows, r, x), threshold(r), b, db, d2b);
    }
    return mollified_derivatives<double>(across_axis(r), obstacle_of(surface, rows.pair[r], x).axis,
                                         threshold_of_axis(r), b, db, d2b);
  }
  BB_HD double mollifier(Index r) const {
    if (!of_axis(rows, r))
      return edge_edge_mollifier_value<double>(leading_points<4>(rows, r, x), threshold(r));
    return edge_axis_mollifier_value<double>(across_axis(r), threshold_of_axis(r));
  }

 private:
  BB_HD double threshold(Index r) const {
    return edge_edge_mollifier_threshold<double>(leading_points<4>(rows, r, surface.rest));
  }
  BB_HD double threshold_of_axis(Index r) const {
    return edge_axis_mollifier_threshold<double>(leading_points<2>(rows, r, surface.rest));
  }
  BB_HD Mat<double, 3, 3> across_axis(Index r) const {
    return about_centre<2, double>(obstacle_of(surface, rows.pair[r], x), leading_points<2>(rows, r, x));
  }
};

/// Gradients of the mollified rows in their points, 0 at given and missing ones, and their mollifiers.
struct MollifiedGradients {
  MollifiedRowAt at;
  const std::uint32_t* list;
  Index n;
  double *gradient, *mollifier;  // [12][n], [n]
  BB_HD void operator()(Index i) const {
    const Index r = list[i];
    const Vec<double, 12> g = at.derivatives(r).gradient;
    for (int c = 0; c < 12; ++c) gradient[c * n + i] = at.rows.is_free(r, c / 3) ? g[c] : 0.0;
    mollifier[i] = at.mollifier(r);
  }
};

/// How those gradients change, to first order, along a motion of prescribed vertices.
struct MollifiedChanges {
  MollifiedRowAt at;
  const std::uint32_t* list;
  Index n;
  const double* motion;
  double* change;  // [12][n]
  BB_HD void operator()(Index i) const {
    const Index r = list[i];
    Vec<double, 12> stacked, out = Vec<double, 12>::Zero();
    bool moves = false;
    const int n_points = of_axis(at.rows, r) ? 2 : 4;  // behind them the obstacle, where it moves
    const Index obstacle = n_points == 2 ? at.rows.vertex[2 * at.rows.n + r] : -1;
    for (int c = 0; c < 12; ++c) {
      const Index vertex = c / 3 < n_points ? at.rows.vertex[c / 3 * at.rows.n + r] : -1;
      stacked[c] = vertex < 0 ? 0.0 : motion[3 * vertex + c % 3];
      if (vertex >= 0 && obstacle >= 0) stacked[c] -= motion[3 * obstacle + c % 3];
      moves = moves || stacked[c] != 0;
    }
    // On the host Eigen adds up other products of this size in another order than on a device.
    if (moves) out = at.derivatives(r).hessian.lazyProduct(stacked);
    for (int c = 0; c < 12; ++c) change[c * n + i] = at.rows.is_free(r, c / 3) ? out[c] : 0.0;
  }
};

/// Rows whose Hessians are kept at a time: those of a list, or neighbours.
struct RowChunk {
  const std::uint32_t* list;  // [n] ascending; null: rows from first on
  Index first, n;
  BB_HD Index row(Index i) const { return list ? static_cast<Index>(list[i]) : first + i; }
  BB_HD Index first_row() const { return row(0); }
  BB_HD Index last_row() const { return row(n - 1); }
  /// Of a row that is there.
  BB_HD Index place(Index row) const {
    return list ? first_not_below(list, Index{0}, n, static_cast<std::uint32_t>(row)) : row - first;
  }
};

/// Whether the Hessian of a row is computed before it is gathered.
BB_HD inline bool has_own_hessian(const RowView& rows, HessianMode mode, Index r) {
  if (rows.mollified(r)) return true;
  const int kind = rows.kind[r];
  const bool slides =
      kind != static_cast<int>(ContactKind::point_point) && kind != static_cast<int>(ContactKind::obstacle);
  return mode != HessianMode::gauss_newton && slides && rows.force[r] != 0;
}

/// Where a kernel puts the Hessian of a row of the chunk.
struct RowHessians {
  RowView rows;
  RowChunk chunk;
  Index stride;
  double* number;  // [row_numbers][stride]
  const double* x;
  SurfaceView surface;
  HessianChoice choice;
};

struct MollifiedHessians {
  RowHessians to;
  BB_HD void operator()(Index i) const {
    const Index r = to.chunk.row(i);
    if (!to.rows.mollified(r)) return;
    int n = 0, front[4] = {-1, -1, -1, -1};
    for (int k = 0; k < 4; ++k) {
      if (to.rows.is_free(r, k)) front[k] = n++;
    }
    const Mat<double, 12, 12> exact =
        moved_to_front(to.rows.free[r], MollifiedRowAt{to.rows, to.surface, to.x}.derivatives(r).hessian);
    Mat<double, 12, 12> h = exact;
    project_leading<double>(n, to.choice.projection_of(to.rows, r), h);
    int at = 0;
    for (int b = 0; b < 4; ++b) {
      for (int a = b; a < 4; ++a) {
        for (int c = 0; c < 9; ++c, ++at) {
          double value = 0;
          if (front[a] >= 0 && front[b] >= 0) {
            const int row = 3 * front[a] + c % 3, column = 3 * front[b] + c / 3;
            value = h(row, column);
            if (to.choice.blended) value = blend(exact(row, column), value, to.choice.t);
          }
          to.number[at * to.stride + i] = value;
        }
      }
    }
  }
};

/// Puts the Hessian of a row whose closest points slide along F edges.
template <int F>
BB_HD void store_sliding(const RowHessians& to, Index i, Projection projection,
                         const RowShape<double, F>& shape) {
  double blocks[row_numbers];
  row_hessian<double, F>(shape, projection, blocks);
  if (!to.choice.blended) {
    for (int c = 0; c < row_numbers; ++c) to.number[c * to.stride + i] = blocks[c];
    return;
  }
  double exact[row_numbers];
  row_hessian<double, F>(shape, Projection::none, exact);
  for (int c = 0; c < row_numbers; ++c)
    to.number[c * to.stride + i] = blend(exact[c], blocks[c], to.choice.t);
}

/// Thickness of the primitive of an obstacle's row: that of an edge may come from a triangle, m.
BB_HD inline double obstacle_offset(const SurfaceView& surface, Key pair) {
  const bool edge = pair_list(pair) == obstacle_pairs_of<2>;
  return edge ? surface.edges.offset[pair_first(pair)] : surface.triangles.offset[pair_first(pair)];
}

struct RowPointsAt {
  const RowView& rows;
  Index r;
  const double* x;
  template <int N>
  BB_HD Mat<double, 3, N> first() const {
    return leading_points<N>(rows, r, x);
  }
};

/// f(the local frame of row r), where its closest points slide along edges; 0 at given points. Requires a row without mollifier.
template <class F>
BB_HD void with_row_shape(const RowView& rows, const SurfaceView& surface, Index r, const double* x,
                          const F& f) {
  const ContactKind kind = static_cast<ContactKind>(rows.kind[r]);
  double offset = 0;
  Vec3d axis = Vec3d::Zero();
  if (is_obstacle(kind)) {
    const AnalyticSurface<double> obstacle = obstacle_of(surface, rows.pair[r], x);
    if (obstacle.kind == ObstacleKind::cylinder) axis = obstacle.axis;
    offset = obstacle_offset(surface, rows.pair[r]) + obstacle.radius;
  } else {
    offset = pair_offset(surface, rows.pair[r]);
  }
  const SlidingRow<double> row{kind,
                               rows.free[r],
                               weights_of(rows, r),
                               rows.normal_of(r),
                               rows.d[r] + offset,
                               rows.stiffness[r],
                               rows.force[r]};
  with_sliding_shape<double>(row, RowPointsAt{rows, r, x}, axis, f);
}

/// Rows whose closest points slide; what is to be 0 is not computed.
struct SlidingHessians {
  RowHessians to;
  BB_HD void operator()(Index i) const {
    const Index r = to.chunk.row(i);
    if (!has_own_hessian(to.rows, to.choice.mode, r)) return;
    if (to.rows.mollified(r)) return;
    const Projection projection = to.choice.projection_of(to.rows, r);
    with_row_shape(to.rows, to.surface, r, to.x,
                   [&](const auto& shape) { store_sliding(to, i, projection, shape); });
  }
};

/// grad^2 d = w w^T x curvature (I - n n^T - flat flat^T) of a row whose closest points slide nowhere.
struct RowCurvature {
  double curvature;  // 1/m
  Vec3d flat;
};

BB_HD inline RowCurvature row_curvature(const RowView& rows, const SurfaceView& surface, Index r,
                                        const double* x) {
  if (rows.kind[r] != static_cast<std::uint8_t>(ContactKind::obstacle)) {
    return {1 / (rows.d[r] + pair_offset(surface, rows.pair[r])), Vec3d::Zero()};
  }
  const Index v = rows.vertex[r];
  const SurfaceGap<double> gap =
      surface_gap<double>(obstacle_of(surface, rows.pair[r], x), Vec3d(x[3 * v], x[3 * v + 1], x[3 * v + 2]));
  return {gap.curvature, gap.flat};
}

}  // namespace bb::exec
