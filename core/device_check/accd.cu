// ACCD as device code, all kinds of pairs.
#include "core/geometry/accd.hpp"

#include "core/device_check/slots.hpp"

namespace bb::device_check {

template <PairKind K, class T>
__device__ void accd_of_pair(Slots<T>& slots) {
  constexpr int N = pair_points(K);
  const Mat<T, 3, N> x0 = slots.template read<Mat<T, 3, N>>(), x1 = slots.template read<Mat<T, 3, N>>();
  const T offset = slots.scalar(), park = slots.scalar();
  const AccdResult<T> result = accd<K, T>(x0, x1, offset, park);
  slots.write(result.toi), slots.write(T(result.hit)), slots.write(T(result.probes));
}
template <class T>
__global__ void sweeps(const T* in, T* out) {
  Slots<T> slots{in, out};
  accd_of_pair<PairKind::point_point, T>(slots);
  accd_of_pair<PairKind::point_edge, T>(slots);
  accd_of_pair<PairKind::point_triangle, T>(slots);
  accd_of_pair<PairKind::edge_edge, T>(slots);
}
BB_DEVICE_CHECK(sweeps);

}  // namespace bb::device_check
