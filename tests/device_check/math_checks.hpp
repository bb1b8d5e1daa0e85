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
struct SymmetricEigen : Columns<T> {
  BB_HD void operator()(exec::Index i) const {
    Slots<T> slots = this->slots(i);
    const Mat<T, N, N> b = slots.template read<Mat<T, N, N>>();
    Mat<T, N, N> a;
    for (int r = 0; r < N; ++r) {
      for (int c = 0; c < N; ++c) a(r, c) = r < c ? b(r, c) : b(c, r);
    }
    const T shift = T(N) * slots.scalar();  // some are positive definite
    for (int r = 0; r < N; ++r) a(r, r) += shift;
    Vec<T, N> values;
    Mat<T, N, N> vectors;
    sym_eigen<T, N>(a, values, vectors);
    int n_clamped = 0;
    slots.write(project<T, N>(a, Projection::psd, &n_clamped));
    slots.write(values), slots.write(vectors), slots.write(T(n_clamped));
  }
};

}  // namespace bb::device_check
