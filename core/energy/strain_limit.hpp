// Strain limiting of one triangle: a barrier on the singular values of F. The barrier's shape is evaluated
// outside, in batches, at the pseudo-gaps that `strain_gap` gives; its terms come back here as numbers.
#pragma once

#include <cmath>
#include <limits>

#include "core/energy/isotropic.hpp"
#include "core/energy/triangle_membrane.hpp"

namespace bb {

/// Where the barrier acts: above 1 + onset, never to reach 1 + onset + width.
template <class T>
struct StrainBand {
  T onset;  // 1, >= 0
  T width;  // 1, > 0; the barrier's activation distance
};

/// y = width - ((sigma - 1) - onset): the barrier's gap; >= width where inactive, <= 0 at or
/// beyond the limit.
template <class T>
BB_HD T strain_gap(T sigma, const StrainBand<T>& band) {
  return band.width - ((sigma - T(1)) - band.onset);
}

/// Barrier terms b(y_k), b'(y_k), b''(y_k) of both singular values, for stiffness 1.
template <class T>
struct StrainShape {
  Vec<T, 2> b, db, d2b;
};

/// S = kappa sum_k b(y_k) as a density in singular values: dS/dsigma = -kappa b', d2S/dsigma2 = kappa b''.
/// flip is the divided difference of dS/dsigma; where the sigmas agree to the cube root of the rounding error
/// (relative to the smaller y, the scale on which b'' varies) the mean of both b'' is more exact than the
/// quotient. kappa in J gives J. Host-device: yes. Total for y_k > 0.
template <class T>
BB_HD Density2<T> strain_limit_density(const Vec<T, 2>& sigma, const StrainBand<T>& band,
                                       const StrainShape<T>& shape, T kappa) {
  using std::abs, std::cbrt;
  Density2<T> out;
  out.psi = kappa * (shape.b[0] + shape.b[1]);
  out.dpsi = -kappa * shape.db;
  out.d2psi = Mat<T, 2, 2>::Zero();
  for (int k = 0; k < 2; ++k) out.d2psi(k, k) = kappa * shape.d2b[k];
  const T difference = sigma[0] - sigma[1], sum = sigma[0] + sigma[1];
  const T close = cbrt(std::numeric_limits<T>::epsilon()) * abs(strain_gap(sigma[0], band));
  out.flip[0] = abs(difference) > close ? (out.dpsi[0] - out.dpsi[1]) / difference
                                        : (out.d2psi(0, 0) + out.d2psi(1, 1)) / T(2);
  out.twist[0] = sum > T(0) ? (out.dpsi[0] + out.dpsi[1]) / sum : T(0);
  return out;
}

/// Energy, gradient and Hessian of one strain-limited triangle; exact zeros when both singular values are
/// inactive.
/// @param svd    of F at x        @param shape  at y_k = strain_gap(sigma_k, band), all y_k > 0
/// @param kappa  J
/// Host-device: yes.
template <int R, class T>
BB_HD ElementTerms<T, 9> strain_limit_terms(const TriangleRest<T>& rest, const Svd<T, R, 2>& svd,
                                            const StrainBand<T>& band, const StrainShape<T>& shape, T kappa,
                                            Projection projection) {
  if (!(strain_gap(svd.sigma[0], band) < band.width)) {
    return {T(0), Vec<T, 9>::Zero(), Mat<T, 9, 9>::Zero()};
  }
  const Density2<T> density = strain_limit_density(svd.sigma, band, shape, kappa);
  return pull_back<R, 2, T>(rest.dm_inv, T(1), isotropic_terms<T, R>(svd, density, projection));
}

/// Smallest pseudo-gap at x, the one number that step bound and energy share: > 0 within the limit.
template <int R, class T>
BB_HD T smallest_strain_gap(const TriangleRest<T>& rest, const Vec<T, 3> (&x)[3], const StrainBand<T>& band) {
  return strain_gap(signed_svd(deformation_gradient<R>(rest, x)).sigma[0], band);
}

/// Largest alpha in [0, alpha_max] whose rounded state x + alpha dx keeps y above the stop level; 0 when x is
/// at or beyond the limit. sigma_max is convex along the step, so what is within is one interval and
/// bisection down to two neighbouring numbers finds its end without a tolerance: the next larger alpha is
/// beyond.
/// @param park  1, stop level in units of the width, as ACCD has one: 0 stops at the hard limit itself, where
/// an unbounded barrier has curvatures that no factorisation survives. Half the start gap for an element that
/// starts below 2 park.
/// Host-device: yes. Cost: one SVD when alpha_max is within, else about 60 in double.
template <int R, class T>
BB_HD T strain_step_bound(const TriangleRest<T>& rest, const Vec<T, 3> (&x)[3], const Vec<T, 3> (&dx)[3],
                          const StrainBand<T>& band, T alpha_max = T(1), T park = T(0)) {
  const auto gap = [&](T alpha) {
    const Vec<T, 3> moved[3] = {x[0] + alpha * dx[0], x[1] + alpha * dx[1], x[2] + alpha * dx[2]};
    return smallest_strain_gap<R>(rest, moved, band);
  };
  T level = park * band.width;
  if (gap(alpha_max) > level) return alpha_max;
  const T start = gap(T(0));
  if (!(start > T(0))) return T(0);
  if (start < T(2) * level) level = start / T(2);
  if (gap(alpha_max) > level) return alpha_max;
  T low = T(0), high = alpha_max;
  for (T middle = high / T(2); low < middle && middle < high; middle = low + (high - low) / T(2)) {
    (gap(middle) > level ? low : high) = middle;
  }
  return low;
}

}  // namespace bb
