// Which candidate pairs have a row, and which row: the rule of surfaces and obstacles, on the host and in kernels.
// Host-device, no allocation.
//
// S is Surface or the view of it that kernels read. Both have
//   is_free(v)                        whether vertex v moves,
//   ruled_at_rest(v, w)               whether two vertices are of one body whose rest shape counts,
//   rest_points<N>(vertex)            their positions at rest, m,
//   planar                            whether the scene is.
#pragma once

#include "core/contact/obstacle_pair.hpp"
#include "core/contact/pair_row.hpp"
#include "core/geometry/edge_axis_mollifier.hpp"
#include "core/geometry/edge_edge_mollifier.hpp"

namespace bb {

/// The row of one candidate pair at one state.
struct FoundRow : PairRow {
  double d_hat, offset;  // m, as in ContactTable
  double eps;            // > 0: the row is mollified, with this threshold (MollifiedTable)
  double curvature;      // 1/m, of rows of obstacles; else 0
  Vec3d flat;            // axis of a cylinder, else 0
  std::uint8_t free;     // bit k: vertex k of the stencil is free
};

/// Whether a gap makes a row: it is less than the activation distance of its pair. A NaN gap counts as active, so that E
/// becomes NaN. T: the scalar in which gaps are compared.
template <class T>
BB_HD inline bool acts(T gap, double d_hat) {
  return !(gap >= static_cast<T>(d_hat));
}

/// Activation distance of a pair, m: that of its two sides, or two thirds of the gap at rest for a pair of one body that is
/// closer than 1.5 d_hat there. A pair that touches or overlaps at rest keeps d_hat: its rest shape shows nothing about a
/// gap. Constant over a run, so B stays continuous.
template <PairKind K, class S>
BB_HD inline double activation_distance(const S& s, const int* vertex, const Side& law) {
  if (!s.ruled_at_rest(vertex[0], vertex[pair_split(K)])) return law.d_hat;
  return d_hat_at_rest<K>(law, s.template rest_points<pair_points(K)>(vertex));
}

/// The threshold of the mollifier of two edges that are close to parallel at these points (m); 0 of edges that are not.
template <class T, class S>
BB_HD inline double mollifier_threshold_at(const S& s, const int* vertex, const Mat<T, 3, 4>& points) {
  const double eps = edge_edge_mollifier_threshold<double>(s.template rest_points<4>(vertex));
  return edge_edge_cross_squared<T>(points) < static_cast<T>(eps) ? eps : 0;
}

namespace detail {
/// Notes which vertices of a row are free; false when none that has a weight is: such a pair has no row.
template <class S>
BB_HD inline bool moves(const S& s, FoundRow& row) {
  bool any = false;
  row.free = 0;
  for (int k = 0; k < 4; ++k) {
    if (row.stencil[k] < 0 || !s.is_free(row.stencil[k])) continue;
    row.free = static_cast<std::uint8_t>(row.free | 1 << k);
    any = any || row.weight[k] != 0;
  }
  return any;
}

/// An obstacle that moves is a point of its row, with minus the weight of the others: relative motion alone opens the gap.
BB_HD inline void add_obstacle_vertex(int vertex, FoundRow& row) {
  if (vertex < 0) return;
  int k = 0;
  double sum = 0;
  for (; k < 3 && row.stencil[k] >= 0; ++k) sum += row.weight[k];
  row.stencil[k] = vertex;
  row.weight[k] = -sum;
}
}  // namespace detail

/// The row of a pair of surface primitives with these points, m. law: that of its two sides; mollifier: whether edges
/// close to parallel are mollified. T: the scalar in which distances are computed. @return whether there is one.
template <PairKind K, class T, class S>
BB_HD inline bool surface_row(const S& s, const int* vertex, const Side& law,
                              const Mat<T, 3, pair_points(K)>& points, bool mollifier, FoundRow& row) {
  const Closest<T, pair_points(K)> closest = closest_points<K, T>(points);
  const T gap = closest.d - static_cast<T>(law.offset);
  if (!acts(gap, law.d_hat)) return false;  // most are: what is tested at rest only makes d_hat smaller
  row.d_hat = activation_distance<K>(s, vertex, law);
  if (!acts(gap, row.d_hat)) return false;
  Region region = closest.region;
  row.eps = 0;
  if constexpr (K == PairKind::edge_edge) {
    if (mollifier) row.eps = mollifier_threshold_at<T>(s, vertex, points);
    if (row.eps > 0) region = Region::ea_eb;
  }
  static_cast<PairRow&>(row) =
      pair_row<T>(vertex, closest.weights.data(), closest.r, closest.d, region, law.offset);
  row.offset = law.offset;
  row.curvature = 0;
  row.flat.setZero();
  return detail::moves(s, row);
}

/// The row of a primitive with N vertices at x (m) and an obstacle, which is where it is in that state. law: that of the primitive.
template <int N, class T, class S>
BB_HD inline bool obstacle_pair_row(const S& s, const int* vertex, const Side& law,
                                    const AnalyticSurface<double>& exact, const Mat<T, 3, N>& x,
                                    bool mollifier, FoundRow& row) {
  const AnalyticSurface<T> obstacle = surface_in<T>(exact);
  const T offset = static_cast<T>(law.offset);
  row.d_hat = law.d_hat;
  row.eps = 0;
  if constexpr (N == 1) {
    const SurfaceGap<T> gap = surface_gap<T>(obstacle, x);
    if (!acts(gap.d - offset, row.d_hat)) return false;
    static_cast<PairRow&>(row) = obstacle_row(vertex[0], gap, offset);
    row.offset = law.offset;
    row.curvature = gap.curvature;
    row.flat = gap.flat.template cast<double>();
  } else {
    const Mat<T, 3, N + 1> points = about_centre<N, T>(obstacle, x);
    Closest<T, N + 1> closest = closest_points<centre_pair<N>, T>(points);
    if (!acts(closest.d - obstacle.radius - offset, row.d_hat)) return false;
    if constexpr (N == 2) {
      if (mollifier && is_line(exact, s.planar)) {
        const double eps = edge_axis_mollifier_threshold<double>(s.template rest_points<2>(vertex));
        if (edge_axis_cross_squared<T>(points) < static_cast<T>(eps)) {
          row.eps = eps;
          closest = on_whole_edge(closest);
        }
      }
    }
    static_cast<PairRow&>(row) = obstacle_row<N, T>(vertex, closest, obstacle.radius, offset);
    row.offset = row.kind == ContactKind::obstacle ? law.offset : law.offset + exact.radius;
    row.curvature = 1 / closest.d;
    row.flat.setZero();
    if (exact.kind == ObstacleKind::cylinder) row.flat = obstacle.axis.template cast<double>();
  }
  detail::add_obstacle_vertex(exact.vertex, row);
  return detail::moves(s, row);
}

}  // namespace bb
