// core/math: eigenvalues, SVD, PSD projection.
#pragma once

#include "core/math/psd.hpp"
#include "core/math/svd.hpp"
#include "tests/device_check/slots.hpp"

namespace bb::device_check {

template <class T>
struct Svds : Columns<T> {
  BB_HD void operator()(exec::Index i) const {
    Slots<T> slots = this->slots(i);
    const Svd22<T> a = svd_2x2<T>(slots.template read<Mat<T, 2, 2>>());
    const Svd32<T> b = svd_3x2<T>(slots.template read<Mat<T, 3, 2>>());
    const Svd33<T> c = svd_3x3<T>(slots.template read<Mat<T, 3, 3>>());
    slots.write(a.U), slots.write(a.sigma), slots.write(a.V);
    slots.write(b.U), slots.write(b.sigma), slots.write(b.V);
    slots.write(c.U), slots.write(c.sigma), slots.write(c.V);
  }
};

template <class T, int N>
BB_HD void eigen_and_projection(Slots<T>& slots) {
  const Mat<T, N, N> b = slots.template read<Mat<T, N, N>>();
  Mat<T, N, N> a;
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < N; ++j) a(i, j) = i < j ? b(i, j) : b(j, i);
  }
  Vec<T, N> values;
  Mat<T, N, N> vectors;
  sym_eigen<T, N>(a, values, vectors);
  int n_clamped = 0;
  slots.write(project<T, N>(a, Projection::psd, &n_clamped));
  slots.write(values), slots.write(vectors), slots.write(T(n_clamped));
}
template <class T>
struct SymmetricEigen : Columns<T> {
  BB_HD void operator()(exec::Index i) const {
    Slots<T> slots = this->slots(i);
    eigen_and_projection<T, 2>(slots);
    eigen_and_projection<T, 3>(slots);
    eigen_and_projection<T, 9>(slots);
    eigen_and_projection<T, 12>(slots);
  }
};

}  // namespace bb::device_check
