// The vertices of a contact in an order that does not depend on which primitive has them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/contact/pair_id.hpp"

namespace bb {

/// Sorted ids of all vertices of a contact, prescribed ones included, -1 padded in front; an obstacle o appears as -2 - o.
/// Pairs with the same closest feature have the same.
using ContactKey = std::array<int, 4>;
constexpr int id_of_obstacle(int obstacle) { return -2 - obstacle; }
/// The obstacle of an entry of a key; -1 where it is a vertex or padding.
constexpr int obstacle_of(int id) { return id < -1 ? -2 - id : -1; }

/// Of one to four vertices.
template <std::size_t N>
ContactKey pair_key(const std::array<int, N>& vertex) {
  ContactKey key{-1, -1, -1, -1};
  std::copy(vertex.begin(), vertex.end(), key.begin());
  std::sort(key.begin(), key.end());
  return key;
}

/// Of an obstacle and vertices (one to three).
template <std::size_t N>
ContactKey obstacle_key(int obstacle, const std::array<int, N>& vertex) {
  std::array<int, 3> ids{-1, -1, -1};
  std::copy(vertex.begin(), vertex.end(), ids.begin());
  std::sort(ids.begin(), ids.end());
  ContactKey key{-1, ids[0], ids[1], ids[2]};
  for (std::size_t k = 4; k-- > 0;) {
    if (key[k] != -1) continue;
    key[k] = id_of_obstacle(obstacle);
    break;
  }
  return key;
}

/// Of the row of a pair. stencil: its four vertices, -1 padded.
inline ContactKey row_key(PairId pair, const std::array<int, 4>& stencil) {
  const int obstacle = pair_obstacle(pair);
  if (obstacle < 0) return pair_key(stencil);
  return obstacle_key(obstacle, std::array{stencil[0], stencil[1], stencil[2]});
}

}  // namespace bb
