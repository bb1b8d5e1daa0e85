// The eigen-filtered machinery of isotropic membranes: from the derivatives of psi in the singular values to
// dpsi/dF and d2psi/dF2 in closed form, exact or with its negative eigenvalues projected.
#pragma once

#include "core/energy/density.hpp"
#include "core/energy/terms.hpp"
#include "core/math/svd.hpp"
#include "core/math/sym_eigen.hpp"

namespace bb {

/// Derivatives of a density in F (R x 2); vec(F) is column-stacked.
template <class T, int R>
struct DensityTerms {
  T psi;
  Mat<T, R, 2> pk1;           // dpsi/dF
  Mat<T, 2 * R, 2 * R> hess;  // d2psi/dF2
};

/// F = U diag(sigma) V^T, the SVD that the membranes use: 2x2 with the sign of det F on sigma_1, 3x2 with
/// sigma >= 0.
template <class T>
BB_HD Svd<T, 2, 2> membrane_svd(const Mat<T, 2, 2>& f) {
  return svd_2x2(f);
}
template <class T>
BB_HD Svd<T, 3, 2> membrane_svd(const Mat<T, 3, 2>& f) {
  return svd_3x2(f);
}

/// Adds the projected eigenvalue * vec(mode) vec(mode)^T, |mode| = 1.
template <class T, int R>
BB_HD void add_mode(T eigenvalue, const Mat<T, R, 2>& mode, Projection projection,
                    Mat<T, 2 * R, 2 * R>& hess) {
  const T projected = project_eigenvalue(eigenvalue, projection);
  if (projected == T(0)) return;
  for (int i = 0; i < 2 * R; ++i) {
    const T scaled = projected * mode.data()[i];
    for (int j = 0; j <= i; ++j) hess(i, j) += scaled * mode.data()[j];
  }
}

/// dpsi/dF = U diag(dpsi) V^T and d2psi/dF2 = sum of eigenvalue q q^T over the modes q = vec(U Q V^T):
///   scaling  Q = diag(eigenvector of psi_ij)   its eigenvalue
///   flip     Q = [0 1; 1 0]/sqrt 2             (psi_0 - psi_1)/(s_0 - s_1)
///   twist    Q = [0 -1; 1 0]/sqrt 2            (psi_0 + psi_1)/(s_0 + s_1)
///   3x2 only, out of plane: n v_k^T            psi_k/s_k, n = u_0 x u_1
/// Where s_k = 0 exactly, psi_k/s_k is replaced by its limit psi_kk for a smooth density (psi_k = 0), by 0 at
/// the top of a cusp. Host-device: yes. Total. Cost: six rank-1 updates. Source: Smith, de Goes, Kim 2019
/// (Analytic Eigensystems for Isotropic Distortion Energies); Poya et al. 2023.
template <class T, int R>
BB_HD DensityTerms<T, R> isotropic_terms(const Svd<T, R, 2>& svd, const Density2<T>& density,
                                         Projection projection) {
  DensityTerms<T, R> out;
  out.psi = density.psi;
  const Vec<T, R> u0 = svd.U.col(0), u1 = svd.U.col(1);
  const Vec<T, 2> v0 = svd.V.col(0), v1 = svd.V.col(1);
  const Mat<T, R, 2> m00 = u0 * v0.transpose(), m11 = u1 * v1.transpose();
  const Mat<T, R, 2> m01 = u0 * v1.transpose(), m10 = u1 * v0.transpose();
  out.pk1 = density.dpsi[0] * m00 + density.dpsi[1] * m11;

  out.hess.setZero();
  Vec<T, 2> values;
  Mat<T, 2, 2> vectors;
  sym_eigen<T, 2>(density.d2psi, values, vectors);
  for (int k = 0; k < 2; ++k) {
    const Mat<T, R, 2> mode = vectors(0, k) * m00 + vectors(1, k) * m11;
    add_mode<T, R>(values[k], mode, projection, out.hess);
  }
  const T inv_sqrt2 = T(0.70710678118654752440);
  add_mode<T, R>(density.flip, inv_sqrt2 * (m01 + m10), projection, out.hess);
  add_mode<T, R>(density.twist, inv_sqrt2 * (m10 - m01), projection, out.hess);
  if constexpr (R == 3) {
    const Vec<T, 3> n = u0.cross(u1);
    for (int k = 0; k < 2; ++k) {
      const T s = svd.sigma[k], dpsi = density.dpsi[k];
      const T eigenvalue = s > T(0) ? dpsi / s : (dpsi < T(0) ? T(0) : density.d2psi(k, k));
      add_mode<T, R>(eigenvalue, n * svd.V.col(k).transpose(), projection, out.hess);
    }
  }
  mirror_lower<T, 2 * R>(out.hess);
  return out;
}

/// A membrane model made of a density in singular values: the interface that every line
/// of registry.inc offers.
template <class Density>
struct Isotropic {
  /// psi(F), in the units of the Lame parameters. Host-device: yes.
  template <class T, int R>
  BB_HD static T value(const Mat<T, R, 2>& f, T lame_mu, T lame_lambda) {
    return Density::template eval<T>(membrane_svd(f).sigma, lame_mu, lame_lambda).psi;
  }
  /// psi, dpsi/dF, d2psi/dF2. Host-device: yes.
  template <class T, int R>
  BB_HD static DensityTerms<T, R> terms(const Mat<T, R, 2>& f, T lame_mu, T lame_lambda,
                                        Projection projection) {
    const Svd<T, R, 2> svd = membrane_svd(f);
    return isotropic_terms<T, R>(svd, Density::template eval<T>(svd.sigma, lame_mu, lame_lambda), projection);
  }
};

}  // namespace bb
