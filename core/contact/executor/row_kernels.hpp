// Narrow phase: which candidate pairs have a contact row, and the rows (core/contact/row_rule.hpp).
#pragma once

#include "core/contact/executor/candidate_lists.hpp"
#include "core/contact/executor/executor_pair.hpp"
#include "core/contact/executor/executor_rows.hpp"
#include "core/contact/row_rule.hpp"
#include "core/exec/sums/compaction_kernels.hpp"
#include "core/exec/sums/sum_kernels.hpp"

namespace bb::exec {

/// Applies the rule to a candidate where no plane proves it far.
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
    const AnalyticSurface<double> obstacle = surface.obstacles[candidate & 0xffffffffu].surface(x);
    const Side law{of.d_hat[i], of.offset[i]};
    const Mat<double, 3, N> at = points_of<N>(x, vertex);
    if constexpr (N > 1) {
      if (far_from_centre<N>(obstacle, about_centre<N, double>(obstacle, at), law.d_hat + law.offset))
        return false;
    }
    return obstacle_pair_row<N, double>(surface, vertex, law, obstacle, at, mollifier, out);
  }
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

/// The row of a candidate of any list.
BB_HD inline bool find_row(const NarrowPhase& phase, const CandidateItem& item, FoundRow& out) {
  switch (item.list) {
    case 0:
      return phase.find<PairKind::point_point>(item.pair, out);
    case 1:
      return phase.find<PairKind::point_edge>(item.pair, out);
    case 2:
      return phase.find<PairKind::point_triangle>(item.pair, out);
    case 3:
      return phase.find<PairKind::edge_edge>(item.pair, out);
    case 4:
      return phase.find_obstacle_pair<1>(item.pair, out);
    case 5:
      return phase.find_obstacle_pair<2>(item.pair, out);
    default:
      return phase.find_obstacle_pair<3>(item.pair, out);
  }
}

/// What is read of a search, once.
struct RowNumbers {
  std::uint32_t not_finite, unused;  // a coordinate that is NaN or infinite
  Key least_gap;                     // smallest_key(); NaN gaps are not counted; all ones before
  Key slots, contributions;          // free points of rows, and pairs a <= b of them
};

/// Ranks the candidates that have a row, and with them the mollified ones; block b of the candidates, then of x.
struct RankRows {
  static constexpr Index coordinates = 8 * block_threads;  // of x, a block
  struct Shared {
    RankShared rank;
    Key least[block_threads];
    int free[block_threads];  // slots, contributions from bit 16 on
  };
  NarrowPhase phase;
  CandidateLists lists;
  RankPlaces to;
  std::uint8_t* mark;  // [n] 1: has a row
  Index n_coordinates;
  RowNumbers* numbers;

  Index n_blocks() const { return to.n_blocks + (n_coordinates + coordinates - 1) / coordinates; }

  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    if (b >= to.n_blocks) return check(block, b - to.n_blocks);
    const auto counts = [&](Index i) {
      const int t = static_cast<int>(i - b * block_threads);
      return find(i, shared.least[t], shared.free[t]);
    };
    block.threads([&](int t) {
      shared.least[t] = ~Key{0};
      shared.free[t] = 0;
    });
    rank_block<true>(block, shared.rank, to, b, counts);
    fold(block, shared.free, block_threads);
    fold(block, shared.least, block_threads, LeastOf{});
    block.once([&] {
      const int free = shared.free[0];
      if (free == 0) return;
      atomic_add(&numbers->slots, static_cast<Key>(free & 0xffff));
      atomic_add(&numbers->contributions, static_cast<Key>(free >> 16));
    });
    block.once([&] {
      if (shared.least[0] != ~Key{0}) atomic_min(&numbers->least_gap, shared.least[0]);
    });
  }

 private:
  BB_HD int find(Index i, Key& least, int& free) const {
    FoundRow row;
    const bool found = find_row(phase, lists[i], row);
    mark[i] = found ? 1 : 0;
    if (!found) return 0;
    if (row.d == row.d) least = smallest_key(row.d + 0.0);
    const int f = row.free, n = (f & 1) + (f >> 1 & 1) + (f >> 2 & 1) + (f >> 3 & 1);
    free = n + (n * (n + 1) / 2 << 16);
    return row.eps > 0 ? 1 + (1 << 16) : 1;
  }
  template <class Block>
  BB_HD void check(Block& block, Index b) const {
    block.threads([&](int t) {
      bool found = false;
      for (Index m = 0; m < coordinates; m += block_threads) {
        const Index i = b * coordinates + m + t;
        if (i < n_coordinates) found = found || !(phase.x[i] - phase.x[i] == 0);
      }
      if (found) atomic_or(&numbers->not_finite, 1);
    });
  }
};

/// The rows of marked candidates at their places, and the list of those that are mollified.
struct FillRows {
  NarrowPhase phase;
  CandidateLists lists;
  const std::uint8_t* mark;
  TwoPlaces places;
  RowView rows;
  std::uint32_t* mollified;
  BB_HD void operator()(Index i) const {
    FoundRow row;
    const CandidateItem item = lists[i];
    if (mark[i] == 0 || !find_row(phase, item, row)) return;
    const Index at = places.first(i);
    put_row(rows, at, row, pair_id(item.list, item.pair >> 32, item.pair & 0xffffffffu));
    if (row.eps > 0) mollified[places.second(i)] = static_cast<std::uint32_t>(at);
  }
};

/// Sets *found where the vertices of a row, or which of them are free, are not those of the other table.
struct CompareStencils {
  RowView a, b;  // of one length
  std::uint32_t* found;
  BB_HD void operator()(Index r) const {
    bool same = a.free[r] == b.free[r];
    for (int k = 0; k < 4; ++k) same = same && a.vertex[k * a.n + r] == b.vertex[k * a.n + r];
    if (!same) atomic_or(found, 1);
  }
};

}  // namespace bb::exec
