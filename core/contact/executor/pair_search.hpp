// All candidate pairs of one primitive of a tree: the one place that reports which pairs there are.
#pragma once

#include "core/contact/executor/executor_pair.hpp"
#include "core/contact/executor/tree_view.hpp"
#include "core/contact/obstacle_pair.hpp"
#include "core/contact/rest_rule.hpp"

namespace bb::exec {

/// Rows of N sorted numbers, in lexicographic order.
template <int N>
struct SortedRows {
  const int* row;
  Index n;
  BB_HD bool holds(const int (&wanted)[N]) const {
    Index begin = 0, end = n;
    while (begin < end) {
      const Index middle = begin + (end - begin) / 2;
      int order = 0;
      for (int k = 0; k < N && order == 0; ++k) {
        const int there = row[N * middle + k];
        order = there < wanted[k] ? -1 : there > wanted[k] ? 1 : 0;
      }
      if (order == 0) return true;
      (order < 0 ? begin : end) = order < 0 ? middle + 1 : middle;
    }
    return false;
  }
};

BB_HD inline Key pair_of(Index first, Index second) {
  return static_cast<Key>(first) << 32 | static_cast<Key>(second);
}
BB_HD inline Index first_of(Key pair) { return static_cast<Index>(pair >> 32); }
BB_HD inline Index second_of(Key pair) { return static_cast<Index>(pair & 0xffffffff); }

/// Which pair of the surface a leaf and one that it meets are.
struct LeafPairs {
  const int* second;  // what the primitives of the second tree are in the surface; null: themselves
  bool one_tree;      // first and second are of the same tree
  BB_HD Key pair(Index own, Index found) const {
    const Index other = second ? second[found] : found;
    return one_tree && other < own ? pair_of(other, own) : pair_of(own, other);
  }
  /// Where the leaf at a place begins to look: within one tree behind itself, so that each pair comes once.
  BB_HD Index begin(Index place) const { return one_tree ? place + 1 : 0; }
};

/// Trees of the first and the second primitives of a kind of pair, and what never pairs.
struct PairSearch {
  TreeView first, second;
  LeafPairs leaves;
  SurfaceView surface;
  SortedRows<2> connected;  // planar, of two vertices: mesh edges
  SortedRows<3> opposite;   // planar, of a vertex and an edge: edge and third corner of a triangle
  const double *x0, *x1;    // the motion
};

template <PairKind K>
constexpr bool one_tree = K == PairKind::point_point || K == PairKind::edge_edge;

/// Whether there may be a pair of primitives i and j, as Surface says.
template <PairKind K>
BB_HD bool may_pair(const PairSearch& s, Index i, Index j) {
  if constexpr (K == PairKind::point_point) {
    const int a = s.surface.points.vertex[i], b = s.surface.points.vertex[j];
    const int edge[2] = {a < b ? a : b, a < b ? b : a};
    return !s.connected.holds(edge);
  } else if constexpr (K == PairKind::point_edge) {
    const int v = s.surface.points.vertex[i];
    const int corner[3] = {s.surface.edges.vertex[2 * j], s.surface.edges.vertex[2 * j + 1], v};
    return v != corner[0] && v != corner[1] && !s.opposite.holds(corner);
  } else if constexpr (K == PairKind::point_triangle) {
    const int v = s.surface.points.vertex[i];
    const int* const t = s.surface.triangles.vertex + 3 * j;
    return v != t[0] && v != t[1] && v != t[2];
  } else {
    const int *const a = s.surface.edges.vertex + 2 * i, *const b = s.surface.edges.vertex + 2 * j;
    return a[0] != b[0] && a[0] != b[1] && a[1] != b[0] && a[1] != b[1];
  }
}

/// Whether the rest rule states something of the pair, and it stays apart as far as that requests it.
template <PairKind K>
BB_HD bool apart_by_rest_rule(const PairSearch& s, Index i, Index j) {
  const PairVertices<K> pair = pair_vertices<K>(s.surface, i, j);
  if (!s.surface.ruled_at_rest(pair.vertex[0], pair.vertex[pair_split(K)])) return false;
  constexpr int n = pair_points(K);
  return bb::apart_by_rest_rule<K>(pair.law, points_of<n>(s.surface.rest, pair.vertex),
                                   points_of<n>(s.x0, pair.vertex), points_of<n>(s.x1, pair.vertex),
                                   value_epsilon(Precision::full));
}

/// Whether a pair whose boxes meet is a candidate.
template <PairKind K>
BB_HD bool is_candidate(const PairSearch& s, Key pair) {
  const Index i = first_of(pair), j = second_of(pair);
  return may_pair<K>(s, i, j) && !apart_by_rest_rule<K>(s, i, j);
}
/// Calls f(first, second) for the candidates of kind K that the leaf at a place of the first tree has.
template <PairKind K, class F>
BB_HD void for_each_pair(const PairSearch& s, Index place, const F& f) {
  const TreeNode asking = s.first.leaf(place);
  for_each_overlap(s.second, asking, s.leaves.begin(place), [&](Index found) {
    const Key pair = s.leaves.pair(asking.primitive(), found);
    if (is_candidate<K>(s, pair)) f(first_of(pair), second_of(pair));
    return true;
  });
}

/// Whether primitive i with N vertices may come within its contact distance of obstacle o on x0 -> x1.
template <int N>
BB_HD bool may_reach(const SurfaceView& s, Index i, int o, const double* x0, const double* x1) {
  const PrimitiveView<N>& of = s.primitives<N>();
  const AnalyticSurface<double> obstacle = s.obstacles[o].surface(x0), end = s.obstacles[o].surface(x1);
  if (of.free[i] == 0 || !pairs_with<N>(obstacle, s.planar, of.lone[i] != 0)) return false;
  const int* const vertex = of.vertex + N * i;
  return bb::may_reach<N>(obstacle, end, points_of<N>(x0, vertex), points_of<N>(x1, vertex),
                          of.d_hat[i] + of.offset[i]);
}

}  // namespace bb::exec
