// The four kinds of primitive pairs and the order of their points: first primitive, then second.
#pragma once

#include "core/math/host_device.hpp"

namespace bb {

/// Points in order: p q | p e0 e1 | p t0 t1 t2 | ea0 ea1 eb0 eb1.
enum class PairKind : unsigned char { point_point, point_edge, point_triangle, edge_edge };

/// Number of points of a pair: 2, 3, 4, 4.
BB_HD constexpr int pair_points(PairKind kind) {
  return kind == PairKind::point_point ? 2 : kind == PairKind::point_edge ? 3 : 4;
}

/// Number of points of the first primitive; the second has the rest.
BB_HD constexpr int pair_split(PairKind kind) { return kind == PairKind::edge_edge ? 2 : 1; }

/// The word of configs, queries and records.
constexpr const char* pair_name(PairKind kind) {
  constexpr const char* names[] = {"point_point", "point_edge", "point_triangle", "edge_edge"};
  return names[static_cast<int>(kind)];
}

}  // namespace bb
