// Rows of two edges of which one counts with one of its ends alone, mollified as the pair of the edges is: they take back
// what mollified pairs count twice at a vertex of theirs (pair_corrections.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "core/contact/row_rule.hpp"

namespace bb {

/// Of two edges in the order of their indices, ea0 ea1 eb0 eb1.
inline std::array<int, 4> edge_pair_vertices(const Surface& s, int edge, int other) {
  const std::array<int, 2>&a = s.edges.vertices[static_cast<std::size_t>(std::min(edge, other))],
                        &b = s.edges.vertices[static_cast<std::size_t>(std::max(edge, other))];
  return {a[0], a[1], b[0], b[1]};
}

/// Two edges, and the one of their four points that is all there is of its edge.
struct EdgeEnd {
  PairId pair;
  std::array<int, 4> vertex;
  int at;  // 0..3
  Side law;
};

/// The ends b0, b1, a0, a1 have lists of their own behind those of obstacles.
inline EdgeEnd edge_end(const Surface& s, int edge, int other, int end_vertex) {
  const int first = std::min(edge, other), second = std::max(edge, other);
  EdgeEnd out{0, edge_pair_vertices(s, edge, other), 0, {}};
  while (out.vertex[static_cast<std::size_t>(out.at)] != end_vertex) ++out.at;
  out.pair = bb::pair_id(end_pairs + out.at, static_cast<PairId>(first), static_cast<PairId>(second));
  out.law =
      combine(s.edges.side[static_cast<std::size_t>(first)], s.edges.side[static_cast<std::size_t>(second)]);
  return out;
}

/// Closest points of one of the four points, `at`, and the edge that it is no end of.
template <class T>
Closest<T, 4> closest_at_end(const Mat<T, 3, 4>& x, int at) {
  constexpr Region regions[4][3] = {{Region::ea0_eb0, Region::ea0_eb1, Region::ea0_eb},
                                    {Region::ea1_eb0, Region::ea1_eb1, Region::ea1_eb},
                                    {Region::ea0_eb0, Region::ea1_eb0, Region::ea_eb0},
                                    {Region::ea0_eb1, Region::ea1_eb1, Region::ea_eb1}};
  Closest<T, 4> best;
  best.d = std::numeric_limits<T>::infinity();
  const int e0 = at < 2 ? 2 : 0;
  detail::keep_closer(best, at, e0, e0 + 1, at < 2 ? T(1) : T(-1), x, regions[at]);
  return best;
}

/// Its row at x; its energy is kappa e b(d), e that of the edges and d that of the point and the edge. @return whether there is one.
template <class T>
bool edge_end_row(const Surface& s, const EdgeEnd& end, const PositionsView& x, FoundRow& row) {
  const Closest<T, 4> closest = closest_at_end<T>(gather_in<T>(x, end.vertex), end.at);
  if (!acts(closest.d - static_cast<T>(end.law.offset), end.law.d_hat)) return false;
  static_cast<PairRow&>(row) = pair_row<T>(end.vertex.data(), closest.weights.data(), closest.r, closest.d,
                                           Region::ea_eb, end.law.offset);
  row.d_hat = end.law.d_hat;
  row.offset = end.law.offset;
  row.eps = edge_edge_mollifier_threshold<double>(s.rest_points<4>(end.vertex.data()));
  row.curvature = 0;
  row.flat.setZero();
  return detail::moves(s, row);
}

}  // namespace bb
