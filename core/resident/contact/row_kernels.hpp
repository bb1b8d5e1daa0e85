// Narrow phase: which candidate pairs have a contact row, and the rows. The rules of core/contact/row_builder.hpp.
#pragma once

#include "core/contact/obstacle_pair.hpp"
#include "core/contact/pair_row.hpp"
#include "core/geometry/edge_axis_mollifier.hpp"
#include "core/resident/contact/compaction_kernels.hpp"
#include "core/resident/contact/resident_pair.hpp"
#include "core/resident/contact/resident_rows.hpp"
#include "core/resident/sums/sum_kernels.hpp"

namespace bb::resident {

/// row_d_hat() of core/contact/contact_row.hpp.
template <PairKind K>
BB_HD double activation_distance(const SurfaceView& s, const PairVertices<K>& pair) {
  if (s.body[pair.vertex[0]] != s.body[pair.vertex[pair_split(K)]]) return pair.law.d_hat;
  return d_hat_at_rest<K>(pair.law, points_of<pair_points(K)>(s.rest, pair.vertex));
}

/// A row before it has a place.
struct FoundRow {
  int vertex[4];
  double weight[4];
  Vec3d normal;
  double d, d_hat;
  std::uint8_t kind, free;
};

struct NarrowPhase {
  SurfaceView surface;
  const double* x;  // [3 n_vertices] m
  bool mollifier;

  /// False when the pair has no row: far, resting as near as that, or none of its vertices moves.
  template <PairKind K>
  BB_HD bool find(Key candidate, FoundRow& out) const {
    constexpr int n = pair_points(K);
    PairVertices<K> pair = pair_vertices<K>(surface, static_cast<Index>(candidate >> 32),
                                            static_cast<Index>(candidate & 0xffffffffu));
    const Mat<double, 3, n> points = points_of<n>(x, pair.vertex);
    if (farther_than<K>(points, pair.law.d_hat + pair.law.offset)) return false;
    const Closest<double, n> closest = closest_points<K, double>(points);
    const double gap = closest.d - pair.law.offset;
    if (gap >= pair.law.d_hat) return false;
    pair.law.d_hat = activation_distance<K>(surface, pair);
    if (gap >= pair.law.d_hat) return false;
    Region region = closest.region;
    bool parallel = false;
    if constexpr (K == PairKind::edge_edge) {
      if (mollifier) {
        const double eps = edge_edge_mollifier_threshold<double>(points_of<4>(surface.rest, pair.vertex));
        parallel = edge_edge_cross_squared<double>(points) < eps;
        if (parallel) region = Region::ea_eb;
      }
    }
    const PairRow row =
        pair_row<double>(pair.vertex, closest.weights.data(), closest.r, closest.d, region, pair.law.offset);
    out.d_hat = pair.law.d_hat;
    out.kind = parallel ? mollified_kind : static_cast<std::uint8_t>(row.kind);
    return take(row, out);
  }

  /// Of an edge (N = 2) or a triangle outside a sphere or cylinder.
  template <int N>
  BB_HD bool find_obstacle_pair(Key candidate, FoundRow& out) const {
    const Index i = static_cast<Index>(candidate >> 32);
    const PrimitiveView<N>& of = surface.primitives<N>();
    const int* const vertex = of.vertex + N * i;
    const AnalyticSurface<double> obstacle = surface.obstacles[candidate & 0xffffffffu].surface();
    const double d_hat = of.d_hat[i], offset = of.offset[i];
    const Mat<double, 3, N + 1> points = about_centre<N, double>(obstacle, points_of<N>(x, vertex));
    if (far_from_centre<N>(obstacle, points, d_hat + offset)) return false;
    Closest<double, N + 1> closest = closest_points<centre_pair<N>, double>(points);
    if (closest.d - obstacle.radius - offset >= d_hat) return false;
    bool parallel = false;
    if constexpr (N == 2) {
      if (mollifier && is_line(obstacle, surface.planar)) {
        const double eps = edge_axis_mollifier_threshold<double>(points_of<2>(surface.rest, vertex));
        parallel = edge_axis_cross_squared<double>(points) < eps;
        if (parallel) closest = on_whole_edge(closest);
      }
    }
    const PairRow row = obstacle_row<N, double>(vertex, closest, obstacle.radius, offset);
    out.d_hat = d_hat;
    out.kind = parallel ? mollified_kind : static_cast<std::uint8_t>(row.kind);
    return take(row, out);
  }

  BB_HD bool find_obstacle(Key candidate, FoundRow& out) const {
    const Index i = static_cast<Index>(candidate >> 32);
    const int v = surface.points.vertex[i];
    const AnalyticSurface<double> obstacle = surface.obstacles[candidate & 0xffffffffu].surface();
    const Vec3d p(x[3 * static_cast<Index>(v)], x[3 * static_cast<Index>(v) + 1],
                  x[3 * static_cast<Index>(v) + 2]);
    const SurfaceGap<double> gap = surface_gap<double>(obstacle, p);
    out.d = gap.d - surface.points.offset[i];
    out.d_hat = surface.points.d_hat[i];
    if (out.d >= out.d_hat) return false;
    for (int k = 0; k < 4; ++k) {
      out.vertex[k] = k == 0 ? v : -1;
      out.weight[k] = k == 0 ? 1 : 0;
    }
    out.normal = gap.normal;
    out.kind = static_cast<std::uint8_t>(ContactKind::obstacle);
    out.free = surface.vertex_free[v] != 0 ? 1 : 0;
    return true;
  }

 private:
  /// What a pair says of its row; false when none of its vertices moves.
  BB_HD bool take(const PairRow& row, FoundRow& out) const {
    bool moves = false;
    out.free = 0;
    for (int k = 0; k < 4; ++k) {
      out.vertex[k] = row.stencil[k];
      out.weight[k] = row.weight[k];
      if (row.stencil[k] < 0 || surface.vertex_free[row.stencil[k]] == 0) continue;
      out.free = static_cast<std::uint8_t>(out.free | 1 << k);
      moves = moves || row.weight[k] != 0;
    }
    out.normal = row.normal;
    out.d = row.d;
    return moves;
  }
};

/// Keys of LeastKey: the smallest gap of rows; what is no number counts for none.
struct RowGaps {
  const double* d;
  BB_HD Key operator()(Index r) const { return d[r] == d[r] ? smallest_key(d[r] + 0.0) : ~Key{0}; }
};

BB_HD inline void put_row(const RowView& rows, Index at, const FoundRow& row, Key pair) {
  for (int k = 0; k < 4; ++k) {
    rows.vertex[k * rows.n + at] = row.vertex[k];
    rows.weight[k * rows.n + at] = row.weight[k];
  }
  for (int c = 0; c < 3; ++c) rows.normal[c * rows.n + at] = row.normal[c];
  rows.d[at] = row.d;
  rows.d_hat[at] = row.d_hat;
  rows.pair[at] = pair;
  rows.kind[at] = row.kind;
  rows.free[at] = row.free;
  if (rows.kappa_before) rows.kappa_before[at] = 0;
}

BB_HD inline Key pair_of(int kind, Key candidate) {
  return pair_id(kind, candidate >> 32, candidate & 0xffffffffu);
}

/// The rows of a list of pairs of surface primitives, and of primitives with N vertices and obstacles: what the two kernels below ask.
template <PairKind K>
struct SurfaceRows {
  static constexpr int kind = static_cast<int>(K);
  NarrowPhase phase;
  BB_HD bool find(Key candidate, FoundRow& out) const { return phase.find<K>(candidate, out); }
};
template <int N>
struct ObstacleRows {
  static constexpr int kind = obstacle_pairs_of<N>;
  NarrowPhase phase;
  BB_HD bool find(Key candidate, FoundRow& out) const {
    if constexpr (N == 1) {
      return phase.find_obstacle(candidate, out);
    } else {
      return phase.find_obstacle_pair<N>(candidate, out);
    }
  }
};

/// mark[i] = 1 where candidate i has a row.
template <class Rows>
struct MarkRows {
  Rows of;
  const Key* candidate;
  std::uint8_t* mark;
  BB_HD void operator()(Index i) const {
    FoundRow row;
    mark[i] = of.find(candidate[i], row) ? 1 : 0;
  }
};

/// The rows of marked candidates at their places; first: what items come before those of this list.
template <class Rows>
struct FillRows {
  Rows of;
  const Key* candidate;
  const std::uint8_t* mark;
  Index first;
  Places places;
  RowView rows;
  BB_HD void operator()(Index i) const {
    FoundRow row;
    if (mark[i] == 0 || !of.find(candidate[i], row)) return;
    put_row(rows, places.of(first + i), row, pair_of(Rows::kind, candidate[i]));
  }
};

struct MarkMollified {
  const std::uint8_t* kind;
  std::uint8_t* mark;
  BB_HD void operator()(Index r) const { mark[r] = kind[r] == mollified_kind ? 1 : 0; }
};

/// Sets *found when a number is not finite.
struct FindNonFinite {
  const double* x;
  std::uint32_t* found;
  BB_HD void operator()(Index i) const {
    if (!(x[i] - x[i] == 0)) exec::atomic_or(found, 1);
  }
};

/// Sets *found where the vertices of a row, or which of them are free, are not those of the other table.
struct CompareStencils {
  RowView a, b;  // of one length
  std::uint32_t* found;
  BB_HD void operator()(Index r) const {
    bool same = a.free[r] == b.free[r];
    for (int k = 0; k < 4; ++k) same = same && a.vertex[k * a.n + r] == b.vertex[k * a.n + r];
    if (!same) exec::atomic_or(found, 1);
  }
};

}  // namespace bb::resident
