// Baraff-Witkin membrane: anisotropic, stretch along warp and weft and a shear term. The columns of F are the
// images of the warp and of the weft direction (the axes of the rest frame).
#pragma once

#include "core/energy/isotropic.hpp"
#include "core/math/psd.hpp"

namespace bb {

/// psi = mu/2 ((|F_u|-1)^2 + (|F_v|-1)^2) + lambda/2 (F_u.F_v)^2. Projections take the whole 2R x 2R
/// Hessian. Host-device: yes. Lanes: yes. Total; a column of length 0 (where the energy has a cusp)
/// counts as if 1/|F_k| were 0. Source: Baraff, Witkin 1998; Kim 2020 (A Finite Element
/// Formulation of Baraff-Witkin Cloth).
struct BaraffWitkin {
  static constexpr bool anisotropic = true;  // psi depends on how the columns of F lie in the material

  template <class T, int R>
  BB_HD static T value(const Mat<T, R, 2>& f, T lame_mu, T lame_lambda) {
    const T stretch_u = f.col(0).norm() - T(1), stretch_v = f.col(1).norm() - T(1);
    const T shear = f.col(0).dot(f.col(1));
    return lame_mu / T(2) * (stretch_u * stretch_u + stretch_v * stretch_v) +
           lame_lambda / T(2) * shear * shear;
  }

  /// Whether psi has a cusp at F: one of its columns is 0. Host-device: yes.
  template <class T, int R>
  BB_HD static bool is_cusp(const Mat<T, R, 2>& f, T lame_mu, T) {
    return lame_mu > T(0) && !(f.col(0).norm() > T(0) && f.col(1).norm() > T(0));
  }

  template <class T, int R>
  BB_HD static DensityTerms<T, R> terms(const Mat<T, R, 2>& f, T lame_mu, T lame_lambda,
                                        Projection projection) {
    const T shear = f.col(0).dot(f.col(1));
    DensityTerms<T, R> out;
    out.psi = value<T, R>(f, lame_mu, lame_lambda);
    for (int k = 0; k < 2; ++k) {
      const Vec<T, R> a = f.col(k), b = f.col(1 - k);
      const T length = a.norm();
      const T inverse = select(length > T(0), T(1) / length, T(0));
      const Vec<T, R> direction = inverse * a;
      const T transverse = lame_mu * (T(1) - inverse);
      out.pk1.col(k) = lame_mu * (length - T(1)) * direction + lame_lambda * shear * b;
      out.hess.template block<R, R>(R * k, R * k) =
          transverse * Mat<T, R, R>::Identity() + (lame_mu * inverse) * (direction * direction.transpose()) +
          lame_lambda * (b * b.transpose());
    }
    out.hess.template block<R, R>(R, 0) =
        lame_lambda * (shear * Mat<T, R, R>::Identity() + f.col(0) * f.col(1).transpose());
    mirror_lower<T, 2 * R>(out.hess);
    out.hess = project<T, 2 * R>(out.hess, projection);
    return out;
  }
};

namespace membrane {
using baraff_witkin = BaraffWitkin;
}

}  // namespace bb
