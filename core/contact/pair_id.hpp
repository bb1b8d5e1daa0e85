// The name of a candidate pair over a whole run.
#pragma once

#include <cstdint>

#include "core/math/host_device.hpp"

namespace bb {

/// Identity of one candidate pair over a whole run, whatever features realise it: list << 60 | first << 30 | second, indices
/// into the primitives of Surface, of which there are at most most_primitives of each; second may be an obstacle.
/// Ascending ids are the order of the candidates.
using PairId = std::uint64_t;

BB_HD constexpr PairId pair_id(int list, PairId first, PairId second) {
  return (static_cast<PairId>(list) << 60) | (first << 30) | second;
}
/// The lists of PairKind come first; then that of points and obstacles, of edges and of triangles and obstacles.
constexpr int obstacle_pairs = 4;
/// Behind them lists of two edges of which one counts with an end alone: ea0, ea1, eb0, eb1 (edge_end_row.hpp).
constexpr int end_pairs = 7;

BB_HD constexpr int pair_list(PairId pair) { return static_cast<int>(pair >> 60); }
BB_HD constexpr int pair_first(PairId pair) { return static_cast<int>(pair >> 30 & ((PairId{1} << 30) - 1)); }
BB_HD constexpr int pair_second(PairId pair) { return static_cast<int>(pair & ((PairId{1} << 30) - 1)); }
/// The obstacle of a pair; -1 of one of two surface primitives.
BB_HD constexpr int pair_obstacle(PairId pair) {
  return pair_list(pair) < obstacle_pairs || pair_list(pair) >= end_pairs ? -1 : pair_second(pair);
}
/// The end that counts of such a pair, 0 to 3; -1 of all others.
BB_HD constexpr int pair_end(PairId pair) {
  return pair_list(pair) < end_pairs ? -1 : pair_list(pair) - end_pairs;
}

}  // namespace bb
