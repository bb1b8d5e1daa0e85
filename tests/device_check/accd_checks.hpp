// ACCD, all kinds of pairs.
#pragma once

#include "core/geometry/accd.hpp"

#include "tests/device_check/slots.hpp"

namespace bb::device_check {

template <PairKind K, class T>
BB_HD void accd_of_pair(Slots<T>& slots) {
  constexpr int N = pair_points(K);
  const Mat<T, 3, N> x0 = slots.template read<Mat<T, 3, N>>(), x1 = slots.template read<Mat<T, 3, N>>();
  const T offset = T(0.01) * slots.positive(), park = T(0.1) * slots.positive();
  const AccdResult<T> result = accd<K, T>(x0, x1, offset, park);
  slots.write(result.toi), slots.write(T(result.hit)), slots.write(T(result.probes));
}
template <class T>
struct Sweeps : Columns<T> {
  BB_HD void operator()(exec::Index i) const {
    Slots<T> slots = this->slots(i);
    accd_of_pair<PairKind::point_point, T>(slots);
    accd_of_pair<PairKind::point_edge, T>(slots);
    accd_of_pair<PairKind::point_triangle, T>(slots);
    accd_of_pair<PairKind::edge_edge, T>(slots);
  }
};

}  // namespace bb::device_check
