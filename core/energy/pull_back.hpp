// The constant dF/dx of a linear simplex: from a density's derivatives in F to gradient and Hessian in the coordinates of its points.
#pragma once

#include "core/energy/isotropic.hpp"

namespace bb {

/// Gradient and Hessian in x of weight * psi(F(x)), F = [edges from point 0] dm_inv: dF_aj/dx_ia = w_ij with w the rows of dm_inv
/// and, for point 0, minus their sum. C + 1 points; with R = 2 the z entries are 0. Host-device: yes.
template <int R, int C, class T>
BB_HD ElementTerms<T, 3 * (C + 1)> pull_back(const Mat<T, C, C>& dm_inv, T weight,
                                             const DensityTerms<T, R, C>& density) {
  constexpr int n = C + 1;
  Mat<T, n, C> w;
  w.template bottomRows<C>() = dm_inv;
  for (int j = 0; j < C; ++j) {
    T sum = dm_inv(0, j);
    for (int i = 1; i < C; ++i) sum += dm_inv(i, j);
    w(0, j) = -sum;
  }
  ElementTerms<T, 3 * n> out;
  out.energy = weight * density.psi;
  out.grad.setZero();
  out.hess.setZero();
  for (int i = 0; i < n; ++i) {
    Vec<T, R> force = w(i, 0) * density.pk1.col(0);
    for (int j = 1; j < C; ++j) force += w(i, j) * density.pk1.col(j);
    out.grad.template segment<R>(3 * i) = weight * force;
    for (int k = 0; k <= i; ++k) {
      Mat<T, R, R> block = Mat<T, R, R>::Zero();
      for (int j = 0; j < C; ++j) {
        for (int l = 0; l < C; ++l) {
          block += (weight * w(i, j) * w(k, l)) * density.hess.template block<R, R>(R * j, R * l);
        }
      }
      out.hess.template block<R, R>(3 * i, 3 * k) = block;
    }
  }
  mirror_lower<T, 3 * n>(out.hess);
  return out;
}

}  // namespace bb
