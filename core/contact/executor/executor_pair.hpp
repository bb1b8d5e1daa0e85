// Candidate pairs as kernels read them.
#pragma once

#include "core/contact/executor/executor_surface.hpp"

namespace bb::exec {

/// Vertices of a pair in the order of pair.hpp, and the gap law of its two sides.
template <PairKind K>
struct PairVertices {
  int vertex[pair_points(K)];
  Side law;
};

namespace detail {
template <PairKind K, int A, int B>
BB_HD PairVertices<K> join(const PrimitiveView<A>& a, Index i, const PrimitiveView<B>& b, Index j) {
  PairVertices<K> out;
  for (int k = 0; k < A; ++k) out.vertex[k] = a.vertex[A * i + k];
  for (int k = 0; k < B; ++k) out.vertex[A + k] = b.vertex[B * j + k];
  out.law = combine(Side{a.d_hat[i], a.offset[i]}, Side{b.d_hat[j], b.offset[j]});
  return out;
}
}  // namespace detail

/// The pair of primitives i and j of the surface.
template <PairKind K>
BB_HD PairVertices<K> pair_vertices(const SurfaceView& s, Index i, Index j) {
  if constexpr (K == PairKind::point_point) return detail::join<K>(s.points, i, s.points, j);
  if constexpr (K == PairKind::point_edge) return detail::join<K>(s.points, i, s.edges, j);
  if constexpr (K == PairKind::point_triangle) return detail::join<K>(s.points, i, s.triangles, j);
  if constexpr (K == PairKind::edge_edge) return detail::join<K>(s.edges, i, s.edges, j);
}

}  // namespace bb::exec
