// core/geometry: closest points, distance derivatives, mollifier.
#pragma once

#include "core/geometry/distance_derivatives.hpp"
#include "core/geometry/edge_edge_mollifier.hpp"
#include "tests/device_check/slots.hpp"

namespace bb::device_check {

/// Whether a region is one of this kind of pair.
template <PairKind K>
BB_HD bool is_region_of(Region region) {
  if constexpr (K == PairKind::point_point) return region == Region::p_p;
  if constexpr (K == PairKind::point_edge) return region >= Region::p_e0 && region <= Region::p_e;
  if constexpr (K == PairKind::point_triangle) return region >= Region::p_t0 && region <= Region::p_t;
  if constexpr (K == PairKind::edge_edge) return region >= Region::ea0_eb0;
}

/// Nothing is written where the region is that of another kind; the compiler knows it behind.
template <PairKind K, class T>
BB_HD void distance_of_pair(Slots<T>& slots) {
  constexpr int N = pair_points(K);
  const Mat<T, 3, N> x = slots.template read<Mat<T, 3, N>>();
  const Closest<T, N> closest = closest_points<K, T>(x);
  if (!is_region_of<K>(closest.region)) return;
  slots.write(closest.weights), slots.write(closest.r), slots.write(closest.d);
  slots.write(T(static_cast<int>(closest.region)));
  const DistanceDerivatives<T, N> d = distance_derivatives<T, N>(x, closest);
  slots.write(d.gradient), slots.write(d.hessian);
}
template <class T>
struct Distances : Columns<T> {
  BB_HD void operator()(exec::Index i) const {
    Slots<T> slots = this->slots(i);
    distance_of_pair<PairKind::point_point, T>(slots);
    distance_of_pair<PairKind::point_edge, T>(slots);
    distance_of_pair<PairKind::point_triangle, T>(slots);
    distance_of_pair<PairKind::edge_edge, T>(slots);
  }
};

template <class T>
struct Mollifier : Columns<T> {
  BB_HD void operator()(exec::Index i) const {
    Slots<T> slots = this->slots(i);
    const Mat<T, 3, 4> rest = slots.template read<Mat<T, 3, 4>>(), x = slots.template read<Mat<T, 3, 4>>();
    const T eps = edge_edge_mollifier_threshold<T>(rest);
    const EdgeEdgeMollifier<T> e = edge_edge_mollifier<T>(x, eps);
    slots.write(edge_edge_mollifier_value<T>(x, eps));
    slots.write(e.value), slots.write(e.gradient), slots.write(e.hessian);
  }
};

}  // namespace bb::device_check
