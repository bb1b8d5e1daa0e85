// From one candidate pair to one contact row: the closest points of the pair, the feature that realises them,
// the activation distance of the pair. Plain values; merging and tables are in row_builder.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/contact/contact_table.hpp"
#include "core/contact/pair_geometry.hpp"
#include "core/contact/pair_row.hpp"
#include "core/scene/scene.hpp"

namespace bb {

/// One pair's contribution to B. Rows of several pairs that agree in everything that `row_less` compares are
/// one contact with a multiplicity.
struct ContactRow {
  ContactKind kind;
  PairId pair = 0;
  ContactKey key;
  std::array<int, 4> stencil{-1, -1, -1, -1};
  std::array<double, 4> weight{0, 0, 0, 0};
  Vec3d normal;
  double d, d_hat, offset;
  double curvature = 0;
  Vec3d flat = Vec3d::Zero();
};

/// Order of the table: key, kind, then what tells apart rows of the same vertices.
bool row_less(const ContactRow& a, const ContactRow& b);

/// Sorted ids, -1 padded in front.
ContactKey contact_key(const std::array<int, 4>& stencil);

template <PairKind K>
constexpr ContactKind contact_kind() {
  constexpr ContactKind kinds[] = {ContactKind::point_point, ContactKind::point_edge,
                                   ContactKind::point_triangle, ContactKind::edge_edge};
  return kinds[static_cast<int>(K)];
}

template <std::size_t N>
ContactKey pair_key(const std::array<int, N>& vertex) {
  std::array<int, 4> padded{-1, -1, -1, -1};
  std::copy(vertex.begin(), vertex.end(), padded.begin());
  return contact_key(padded);
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

/// pair_row() with the law of the pair.
template <class T>
ContactRow make_row(const int* vertex, const T* weights, const Vec<T, 3>& r, T distance, Region region,
                    const Side& law);

/// Activation distance of a pair: d_hat, or two thirds of the gap at rest for a pair of one body that is
/// closer than 1.5 d_hat there. A pair that touches or overlaps at rest keeps d_hat: its rest shape says
/// nothing about a gap. Constant over a run, so B stays continuous.
template <PairKind K>
double row_d_hat(const Scene& scene, const ContactPair<K>& pair) {
  const auto body = [&](std::size_t k) { return scene.body[static_cast<std::size_t>(pair.vertex[k])]; };
  if (body(0) != body(static_cast<std::size_t>(pair_split(K)))) return pair.law.d_hat;
  return d_hat_at_rest<K>(pair.law, gather(scene.rest, pair.vertex));
}

}  // namespace bb
