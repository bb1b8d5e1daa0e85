// Narrow phase: which candidate pairs have a contact row, and the rows (core/contact/row_rule.hpp).
#pragma once

#include "core/contact/row_rule.hpp"
#include "core/resident/contact/compaction_kernels.hpp"
#include "core/resident/contact/resident_pair.hpp"
#include "core/resident/contact/resident_rows.hpp"
#include "core/resident/sums/sum_kernels.hpp"

namespace bb::resident {

/// Asks the rule about a candidate where no plane proves it far.
struct NarrowPhase {
  SurfaceView surface;
  const double* x;  // [3 n_vertices] m
  bool mollifier;

  template <PairKind K>
  BB_HD bool find(Key candidate, FoundRow& out) const {
    const PairVertices<K> pair = pair_vertices<K>(surface, static_cast<Index>(candidate >> 32),
                                                  static_cast<Index>(candidate & 0xffffffffu));
    const Mat<double, 3, pair_points(K)> points = points_of<pair_points(K)>(x, pair.vertex);
    if (farther_than<K>(points, pair.law.d_hat + pair.law.offset)) return false;
    return surface_row<K, double>(surface, pair.vertex, pair.law, points, mollifier, out);
  }

  /// Of a primitive with N vertices and an obstacle.
  template <int N>
  BB_HD bool find_obstacle_pair(Key candidate, FoundRow& out) const {
    const Index i = static_cast<Index>(candidate >> 32);
    const PrimitiveView<N>& of = surface.primitives<N>();
    const int* const vertex = of.vertex + N * i;
    const AnalyticSurface<double> obstacle = surface.obstacles[candidate & 0xffffffffu].surface();
    const Side law{of.d_hat[i], of.offset[i]};
    const Mat<double, 3, N> at = points_of<N>(x, vertex);
    if constexpr (N > 1) {
      if (far_from_centre<N>(obstacle, about_centre<N, double>(obstacle, at), law.d_hat + law.offset))
        return false;
    }
    return obstacle_pair_row<N, double>(surface, vertex, law, obstacle, at, mollifier, out);
  }
};

/// Keys of LeastKey: the smallest gap of rows; what is no number counts for none.
struct RowGaps {
  const double* d;
  BB_HD Key operator()(Index r) const { return d[r] == d[r] ? smallest_key(d[r] + 0.0) : ~Key{0}; }
};

BB_HD inline void put_row(const RowView& rows, Index at, const FoundRow& row, Key pair) {
  for (int k = 0; k < 4; ++k) {
    rows.vertex[k * rows.n + at] = row.stencil[k];
    rows.weight[k * rows.n + at] = row.weight[k];
  }
  for (int c = 0; c < 3; ++c) rows.normal[c * rows.n + at] = row.normal[c];
  rows.d[at] = row.d;
  rows.d_hat[at] = row.d_hat;
  rows.pair[at] = pair;
  rows.kind[at] = row.eps > 0 ? mollified_kind : static_cast<std::uint8_t>(row.kind);
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
  BB_HD bool find(Key candidate, FoundRow& out) const { return phase.find_obstacle_pair<N>(candidate, out); }
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
