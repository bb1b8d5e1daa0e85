// The eigen-filtered machinery of isotropic membranes and solids: from the derivatives of psi in the singular values to
// dpsi/dF and d2psi/dF2 in closed form, exact or with its negative eigenvalues projected.
#pragma once

#include <limits>
#include <type_traits>

#include "core/energy/density.hpp"
#include "core/energy/terms.hpp"
#include "core/math/svd.hpp"
#include "core/math/sym_eigen.hpp"

namespace bb {

/// Derivatives of a density in F (R x C: 2 x 2, 3 x 2 or 3 x 3); vec(F) is column-stacked.
template <class T, int R, int C = 2>
struct DensityTerms {
  T psi;
  Mat<T, R, C> pk1;           // dpsi/dF
  Mat<T, R * C, R * C> hess;  // d2psi/dF2
};

/// F = U diag(sigma) V^T, the SVD that the densities use: of a square F with the sign of det F on the last sigma, of 3x2 with
/// sigma >= 0.
template <class T>
BB_HD Svd<T, 2, 2> signed_svd(const Mat<T, 2, 2>& f) {
  return svd_2x2(f);
}
template <class T>
BB_HD Svd<T, 3, 2> signed_svd(const Mat<T, 3, 2>& f) {
  return svd_3x2(f);
}
template <class T>
BB_HD Svd<T, 3, 3> signed_svd(const Mat<T, 3, 3>& f) {
  return svd_3x3(f);
}

/// Adds the projected eigenvalue * vec(mode) vec(mode)^T, |mode| = 1.
template <class T, int R, int C>
BB_HD void add_mode(T eigenvalue, const Mat<T, R, C>& mode, Projection projection,
                    Mat<T, R * C, R * C>& hess) {
  const T projected = project_eigenvalue(eigenvalue, projection);
  const MaskOf<T> nothing = projected == T(0);
  if (!any(!nothing)) return;
  for (int i = 0; i < R * C; ++i) {
    const T scaled = projected * mode.data()[i];
    for (int j = 0; j <= i; ++j) {
      hess(i, j) = select(nothing, hess(i, j), hess(i, j) + scaled * mode.data()[j]);
    }
  }
}

/// U diag(d) V^T.
template <class T, int R, int C>
BB_HD Mat<T, R, C> scaled_axes(const Svd<T, R, C>& svd, const Vec<T, C>& d) {
  Mat<T, R, C> axis = svd.U.col(0) * svd.V.col(0).transpose();
  Mat<T, R, C> out = d[0] * axis;
  for (int k = 1; k < C; ++k) {
    axis = svd.U.col(k) * svd.V.col(k).transpose();
    out += d[k] * axis;
  }
  return out;
}

/// dpsi/dF = U diag(dpsi) V^T and d2psi/dF2 = sum of eigenvalue q q^T over the modes q = vec(U Q V^T):
///   scaling  Q = diag(eigenvector of psi_ij)     its eigenvalue
///   flip     Q = [0 1; 1 0]/sqrt 2 in (i, j)     (psi_i - psi_j)/(s_i - s_j)
///   twist    Q = [0 -1; 1 0]/sqrt 2 in (i, j)    (psi_i + psi_j)/(s_i + s_j)
///   3x2 only, out of plane: n v_k^T              psi_k/s_k, n = u_0 x u_1
/// Where s_k = 0 exactly, psi_k/s_k is replaced by its limit psi_kk for a smooth density (psi_k = 0), by 0 at
/// the top of a cusp. Host-device: yes. Lanes: 3 x 2. Total. Cost: R C rank-1 updates. Source: Smith, de Goes, Kim 2019
/// (Analytic Eigensystems for Isotropic Distortion Energies); Poya et al. 2023.
template <class T, int R, int C>
BB_HD DensityTerms<T, R, C> isotropic_terms(const Svd<T, R, C>& svd, const Density<T, C>& density,
                                            Projection projection) {
  DensityTerms<T, R, C> out;
  out.psi = density.psi;
  out.pk1 = scaled_axes<T, R, C>(svd, density.dpsi);

  out.hess.setZero();
  Vec<T, C> values;
  Mat<T, C, C> vectors;
  sym_eigen<T, C>(density.d2psi, values, vectors);
  for (int k = 0; k < C; ++k) {
    add_mode<T, R, C>(values[k], scaled_axes<T, R, C>(svd, vectors.col(k)), projection, out.hess);
  }
  const T inv_sqrt2(static_cast<typename ScalarOf<T>::type>(0.70710678118654752440));
  for (int i = 0; i < C; ++i) {
    for (int j = i + 1; j < C; ++j) {
      const Mat<T, R, C> ij = svd.U.col(i) * svd.V.col(j).transpose();
      const Mat<T, R, C> ji = svd.U.col(j) * svd.V.col(i).transpose();
      const int pair = sigma_pair(i, j);
      add_mode<T, R, C>(density.flip[pair], inv_sqrt2 * (ij + ji), projection, out.hess);
      add_mode<T, R, C>(density.twist[pair], inv_sqrt2 * (ji - ij), projection, out.hess);
    }
  }
  if constexpr (R > C) {
    const Vec<T, 3> u0 = svd.U.col(0), u1 = svd.U.col(1);
    const Vec<T, 3> n = u0.cross(u1);
    for (int k = 0; k < C; ++k) {
      const T s = svd.sigma[k], dpsi = density.dpsi[k];
      const T at_zero = select(dpsi < T(0), T(0), density.d2psi(k, k));
      const T eigenvalue = select(s > T(0), dpsi / s, at_zero);
      add_mode<T, R, C>(eigenvalue, n * svd.V.col(k).transpose(), projection, out.hess);
    }
  }
  mirror_lower<T, R * C>(out.hess);
  return out;
}

/// Whether psi has a cusp at F: the last singular value of a 3 x 2 F, or the sum of the last two of a square one, is 0 within
/// rounding, and psi falls whichever way F leaves there. Host-device: yes.
template <class T, int R, int C>
BB_HD bool is_isotropic_cusp(const Vec<T, C>& sigma, const Density<T, C>& density, T stiffness) {
  using std::sqrt;
  const T eps = std::numeric_limits<T>::epsilon();
  const T collapsed = R > C ? sigma[C - 1] : sigma[C - 2] + sigma[C - 1];
  const T slope = R > C ? density.dpsi[C - 1] : density.dpsi[C - 2] + density.dpsi[C - 1];
  return collapsed <= T(8) * eps * sigma[0] && slope < -sqrt(eps) * stiffness;
}

/// A model of triangles and of tetrahedra made of a density in singular values: the interface that every line of registry.inc and
/// of solids.inc offers.
template <class InSigma>
struct Isotropic {
  /// psi(F), in the units of the Lame parameters. Host-device: yes.
  template <class T, int R, int C = 2>
  BB_HD static T value(const std::type_identity_t<Mat<T, R, C>>& f, T lame_mu, T lame_lambda) {
    return InSigma::template eval<T, C>(signed_svd(f).sigma, lame_mu, lame_lambda).psi;
  }
  /// psi, dpsi/dF, d2psi/dF2. Host-device: yes.
  template <class T, int R, int C = 2>
  BB_HD static DensityTerms<T, R, C> terms(const std::type_identity_t<Mat<T, R, C>>& f, T lame_mu,
                                           T lame_lambda, Projection projection) {
    const Svd<T, R, C> svd = signed_svd(f);
    return isotropic_terms<T, R, C>(svd, InSigma::template eval<T, C>(svd.sigma, lame_mu, lame_lambda),
                                    projection);
  }
  /// Whether psi has a cusp at F. Host-device: yes.
  template <class T, int R, int C = 2>
  BB_HD static bool is_cusp(const std::type_identity_t<Mat<T, R, C>>& f, T lame_mu, T lame_lambda) {
    const Vec<T, C> sigma = signed_svd(f).sigma;
    return is_isotropic_cusp<T, R, C>(sigma, InSigma::template eval<T, C>(sigma, lame_mu, lame_lambda),
                                      lame_mu);
  }
};

}  // namespace bb
