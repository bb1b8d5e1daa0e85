// core/math: eigenvalues, SVD, PSD projection, elementary functions.
#pragma once

#include "core/math/atan2.hpp"
#include "core/math/exp.hpp"
#include "core/math/log.hpp"
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

/// Of numbers of every size and sign, some of them as they are and some far larger or smaller.
template <class T>
struct Elementary : Columns<T> {
  BB_HD void operator()(exec::Index i) const {
    Slots<T> slots = this->slots(i);
    for (const T size : {T(1), T(0x1p120), T(0x1p-120), T(0)}) {
      const T a = slots.scalar(), b = slots.scalar(), x = size * a,
              near = T(1) - T(0.5) * (a < T(0) ? -a : a);
      slots.write(elementary::log(x)), slots.write(elementary::log(x < T(0) ? -x : x));
      slots.write(elementary::log(near)), slots.write(elementary::minus_log(near, T(1) - near));
      slots.write(elementary::exp(T(40) * a)), slots.write(elementary::expm1(a)),
          slots.write(elementary::exp(x));
      slots.write(elementary::atan2(a, b)), slots.write(elementary::atan2(x, b)),
          slots.write(elementary::atan2(b, x));
    }
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
