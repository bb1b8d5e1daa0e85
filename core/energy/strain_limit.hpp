// Strain limiting of one triangle or tetrahedron: a barrier on the stretches of F, the absolute values of its N singular values.
// The barrier's shape is evaluated outside, in batches, at the pseudo-gaps that `stretch_gap` gives; its terms come back here as
// numbers. Elements with an F of C columns have C + 1 points.
#pragma once

#include <cmath>
#include <limits>

#include "core/energy/isotropic.hpp"
#include "core/energy/tetrahedron.hpp"
#include "core/energy/triangle_membrane.hpp"

namespace bb {

/// Where the barrier acts: above 1 + onset, never to reach 1 + onset + width.
template <class T>
struct StrainBand {
  T onset;  // 1, >= 0
  T width;  // 1, > 0; the barrier's activation distance
};

/// y = width - ((stretch - 1) - onset): the barrier's gap; >= width where inactive, <= 0 at or
/// beyond the limit.
template <class T>
BB_HD T strain_gap(T stretch, const StrainBand<T>& band) {
  return band.width - ((stretch - T(1)) - band.onset);
}
/// That of a singular value, which carries the sign of det F where it is the last one of a square F.
template <class T>
BB_HD T stretch_gap(T sigma, const StrainBand<T>& band) {
  return strain_gap(sigma < T(0) ? -sigma : sigma, band);
}

/// F of both kinds of element in the same words; a tetrahedron has three rows.
template <int R, class T>
BB_HD Mat<T, R, 3> deformation_gradient(const TetrahedronRest<T>& rest, const Vec<T, 3> (&x)[4]) {
  static_assert(R == 3, "tetrahedra live in space");
  return deformation_gradient(rest, x);
}
/// Area (m^2) or volume (m^3) at rest.
template <class T>
BB_HD T rest_measure(const TriangleRest<T>& rest) {
  return rest.area;
}
template <class T>
BB_HD T rest_measure(const TetrahedronRest<T>& rest) {
  return rest.volume;
}

/// Barrier terms b(y_k), b'(y_k), b''(y_k) of all N singular values, for stiffness 1.
template <class T, int N = 2>
struct StrainShape {
  Vec<T, N> b, db, d2b;
};

/// S = kappa sum_k b(y_k) as a density in singular values: dS/d|sigma| = -kappa b', d2S/dsigma2 = kappa b''. It is a function
/// of the stretches, that is of F^T F: as smooth where det F < 0 as elsewhere, and it neither turns an inverted element back nor
/// holds it. flip and twist are divided differences of dS/dsigma; where sigmas agree in size to the cube root of the rounding
/// error (relative to the smaller y, the scale on which b'' varies) the mean of both b'' is more exact than the
/// quotient. kappa in J gives J. Host-device: yes. Total for y_k > 0.
template <class T, int N>
BB_HD Density<T, N> strain_limit_density(const Vec<T, N>& sigma, const StrainBand<T>& band,
                                         const StrainShape<T, N>& shape, T kappa) {
  using std::abs, std::cbrt;
  Density<T, N> out;
  T sum_b = shape.b[0];
  for (int k = 1; k < N; ++k) sum_b += shape.b[k];
  out.psi = kappa * sum_b;
  out.d2psi = Mat<T, N, N>::Zero();
  for (int k = 0; k < N; ++k) {
    out.dpsi[k] = (sigma[k] < T(0) ? kappa : -kappa) * shape.db[k];
    out.d2psi(k, k) = kappa * shape.d2b[k];
  }
  for (int i = 0; i < N; ++i) {
    const T close = cbrt(std::numeric_limits<T>::epsilon()) * abs(stretch_gap(sigma[i], band));
    for (int j = i + 1; j < N; ++j) {
      const T difference = sigma[i] - sigma[j], sum = sigma[i] + sigma[j];
      const T mean = (out.d2psi(i, i) + out.d2psi(j, j)) / T(2);
      const int pair = sigma_pair(i, j);
      out.flip[pair] = abs(difference) > close ? (out.dpsi[i] - out.dpsi[j]) / difference : mean;
      const T quotient = sum > T(0) ? (out.dpsi[i] + out.dpsi[j]) / sum : T(0);
      out.twist[pair] = sigma[j] < T(0) && !(abs(sum) > close) ? mean : quotient;
    }
  }
  return out;
}

/// Energy, gradient and Hessian of one strain-limited element; exact zeros when all singular values are
/// inactive.
/// @param rest   of a triangle or a tetrahedron
/// @param svd    of F at x        @param shape  at y_k = stretch_gap(sigma_k, band), all y_k > 0
/// @param kappa  J
/// Host-device: yes.
template <int R, class T, class Rest, int N>
BB_HD ElementTerms<T, 3 * (N + 1)> strain_limit_terms(const Rest& rest, const Svd<T, R, N>& svd,
                                                      const StrainBand<T>& band,
                                                      const StrainShape<T, N>& shape, T kappa,
                                                      Projection projection) {
  constexpr int n = 3 * (N + 1);
  if (!(strain_gap(svd.sigma[0], band) < band.width)) {
    return {T(0), Vec<T, n>::Zero(), Mat<T, n, n>::Zero()};
  }
  const Density<T, N> density = strain_limit_density<T, N>(svd.sigma, band, shape, kappa);
  return pull_back<R, N, T>(rest.dm_inv, T(1), isotropic_terms<T, R, N>(svd, density, projection));
}

/// Smallest pseudo-gap at x, the one number that step bound and energy share: > 0 within the limit. The first singular value is
/// the largest stretch.
template <int R, class T, class Rest, int P>
BB_HD T smallest_strain_gap(const Rest& rest, const Vec<T, 3> (&x)[P], const StrainBand<T>& band) {
  return strain_gap(signed_svd(deformation_gradient<R>(rest, x)).sigma[0], band);
}

/// Largest alpha in [0, alpha_max] whose rounded state x + alpha dx keeps y above the stop level; 0 when x is
/// at or beyond the limit. The largest stretch, the norm of F, is convex along the step, so what is within is one interval and
/// bisection down to two neighbouring numbers finds its end without a tolerance: the next larger alpha is
/// beyond.
/// @param park  1, stop level in units of the width, as ACCD has one: 0 stops at the hard limit itself, where
/// an unbounded barrier has curvatures that no factorisation survives. Half the start gap for an element that
/// starts below 2 park.
/// Host-device: yes. Cost: one SVD when alpha_max is within, else about 60 in double.
template <int R, class T, class Rest, int P>
BB_HD T strain_step_bound(const Rest& rest, const Vec<T, 3> (&x)[P], const Vec<T, 3> (&dx)[P],
                          const StrainBand<T>& band, T alpha_max = T(1), T park = T(0)) {
  const auto gap = [&](T alpha) {
    Vec<T, 3> moved[P];
    for (int i = 0; i < P; ++i) moved[i] = x[i] + alpha * dx[i];
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
