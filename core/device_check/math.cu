// core/math as device code: eigenvalues, SVD, PSD projection.
#include "core/device_check/slots.hpp"
#include "core/math/psd.hpp"
#include "core/math/svd.hpp"

namespace bb::device_check {

template <class T>
__global__ void svds(const T* in, T* out) {
  Slots<T> slots{in, out};
  const Svd22<T> a = svd_2x2<T>(slots.template read<Mat<T, 2, 2>>());
  const Svd32<T> b = svd_3x2<T>(slots.template read<Mat<T, 3, 2>>());
  const Svd33<T> c = svd_3x3<T>(slots.template read<Mat<T, 3, 3>>());
  slots.write(a.U), slots.write(a.sigma), slots.write(a.V);
  slots.write(b.U), slots.write(b.sigma), slots.write(b.V);
  slots.write(c.U), slots.write(c.sigma), slots.write(c.V);
}
BB_DEVICE_CHECK(svds);

template <class T, int N>
__device__ void eigen_and_projection(Slots<T>& slots) {
  const Mat<T, N, N> a = slots.template read<Mat<T, N, N>>();
  Vec<T, N> values;
  Mat<T, N, N> vectors;
  sym_eigen<T, N>(a, values, vectors);
  int n_clamped = 0;
  slots.write(project<T, N>(a, Projection::psd, &n_clamped));
  slots.write(values), slots.write(vectors), slots.write(T(n_clamped));
}
template <class T>
__global__ void eigen(const T* in, T* out) {
  Slots<T> slots{in, out};
  eigen_and_projection<T, 2>(slots);
  eigen_and_projection<T, 3>(slots);
  eigen_and_projection<T, 9>(slots);
  eigen_and_projection<T, 12>(slots);
}
BB_DEVICE_CHECK(eigen);

}  // namespace bb::device_check
