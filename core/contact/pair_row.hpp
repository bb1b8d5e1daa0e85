// The row of one pair as plain values: which feature realises its closest points, weights, normal and gap. What the table
// and kernels share; host-device, no allocation.
#pragma once

#include "core/contact/contact_table.hpp"
#include "core/contact/pair_geometry.hpp"
#include "core/contact/surface.hpp"
#include "core/geometry/region.hpp"

namespace bb {

/// Kind of a row on the insides of both primitives.
template <PairKind K>
constexpr ContactKind contact_kind() {
  constexpr ContactKind kinds[] = {ContactKind::point_point, ContactKind::point_edge,
                                   ContactKind::point_triangle, ContactKind::edge_edge};
  return kinds[static_cast<int>(K)];
}

/// Local points of a feature in role order (point before edge), -1 padded.
struct FeaturePoints {
  int of[4];
};

/// Of the feature that realises a region.
BB_HD constexpr FeaturePoints feature_points(Region region) {
  switch (region) {
    case Region::p_p:
    case Region::p_e0:
    case Region::p_t0:
      return {{0, 1, -1, -1}};
    case Region::p_e1:
    case Region::p_t1:
    case Region::ea0_eb0:
      return {{0, 2, -1, -1}};
    case Region::p_t2:
    case Region::ea0_eb1:
      return {{0, 3, -1, -1}};
    case Region::ea1_eb0:
      return {{1, 2, -1, -1}};
    case Region::ea1_eb1:
      return {{1, 3, -1, -1}};
    case Region::p_e:
    case Region::p_e01:
      return {{0, 1, 2, -1}};
    case Region::p_e12:
    case Region::ea0_eb:
      return {{0, 2, 3, -1}};
    case Region::p_e20:
      return {{0, 3, 1, -1}};
    case Region::ea_eb0:
      return {{2, 0, 1, -1}};
    case Region::ea_eb1:
      return {{3, 0, 1, -1}};
    case Region::ea1_eb:
      return {{1, 2, 3, -1}};
    case Region::p_t:
    case Region::ea_eb:
      break;
  }
  return {{0, 1, 2, 3}};
}

/// Of a row what its closest points say.
struct PairRow {
  ContactKind kind;
  int stencil[4];    // -1 padded
  double weight[4];  // 0 padded
  Vec3d normal;
  double d;
};

namespace detail {
template <class V>
BB_HD void exchange(V& a, V& b) {
  const V before = a;
  a = b;
  b = before;
}
}  // namespace detail

/// The row of a pair whose closest points are known: its feature in canonical order (the lower id first in a
/// point-point row and within an edge). T: float or double, in which d and the normal are computed.
template <class T>
BB_HD inline PairRow pair_row(const int* vertex, const T* weights, const Vec<T, 3>& r, T distance,
                              Region region, double offset) {
  const FeaturePoints local = feature_points(region);
  PairRow row{ContactKind::point_triangle, {-1, -1, -1, -1}, {0, 0, 0, 0}, Vec3d::Zero(), 0};
  int n = 0;
  for (; n < 4 && local.of[n] >= 0; ++n) {
    row.stencil[n] = vertex[local.of[n]];
    row.weight[n] = weights[local.of[n]];
  }
  T sign = row.weight[0] < 0 ? T(-1) : T(1);  // a vertex of the second edge against the first edge
  if (n == 2 && row.stencil[0] > row.stencil[1]) {
    detail::exchange(row.stencil[0], row.stencil[1]);
    detail::exchange(row.weight[0], row.weight[1]);
    sign = -sign;
  } else if (n == 3 && row.stencil[1] > row.stencil[2]) {
    detail::exchange(row.stencil[1], row.stencil[2]);
    detail::exchange(row.weight[1], row.weight[2]);
  }
  for (int k = 0; k < 4; ++k) row.weight[k] *= sign;
  if (n == 2) row.kind = ContactKind::point_point;
  if (n == 3) row.kind = ContactKind::point_edge;
  if (region == Region::ea_eb) row.kind = ContactKind::edge_edge;
  if (distance > 0) row.normal = (r * (sign / distance)).template cast<double>();
  row.d = distance - static_cast<T>(offset);
  return row;
}

/// Activation distance of a pair of one body with these points at rest: see activation_distance() in row_rule.hpp.
template <PairKind K>
BB_HD inline double d_hat_at_rest(const Side& law, const Mat<double, 3, pair_points(K)>& rest) {
  const double reach = rest_rule_factor * law.d_hat;
  if (pair_box_distance<K>(rest) - law.offset >= reach) return law.d_hat;
  const double gap = closest_points<K, double>(rest).d - law.offset;
  return gap > 0 && gap < reach ? gap / rest_rule_factor : law.d_hat;
}

}  // namespace bb
