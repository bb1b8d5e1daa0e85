// The potential psi of b'/d^2, for shapes that have it in closed form: psi(d) = -int_d^{d_hat} b'(s)/s^2 ds, a
// number without unit. A stiffness kappa_1 (d_hat/d)^2 times the slope of b is the slope of kappa_1 d_hat^2 psi.
// Element math.
#pragma once

#include <limits>

#include "core/barrier/normalized_gap.hpp"

namespace bb::shapes {

/// 1/u - u + 2 ln u >= 0, of which every psi here is made. It falls as 2/3 e^3 towards d_hat, so from e = 1/2 on it
/// is summed: with t = e/(2 - e), ln u = -2 atanh t and 1/u - u = 4 t/(1 - t^2) give
///   4 sum_{j >= 1} 2 j/(2 j + 1) t^(2 j + 1),   t <= 1/3: 18 terms leave 1e-17 of the first
/// Infinite at u = 0.
template <class T>
BB_HD T inverse_gap_excess(const NormalizedGap<T>& gap) {
  using elementary::log;
  if (gap.u == T(0)) return std::numeric_limits<T>::infinity();
  if (gap.e > T(0.5)) return T(1) / gap.u - gap.u + T(2) * log(gap.u);
  const T t = gap.e / (T(2) - gap.e), t_sq = t * t;
  T sum = T(0);
  for (int j = 18; j >= 1; --j) sum = (sum + T(2 * j) / T(2 * j + 1)) * t_sq;
  return T(4) * t * sum;
}

/// A shape with a static psi(NormalizedGap<T>).
template <class S>
concept HasPotential = requires(const NormalizedGap<double>& gap) {
  S::psi(gap);
};

/// d_hat^2 psi and its derivatives: b'(d_hat/d)^2 and (b'' - 2 b'/d)(d_hat/d)^2. Requires d >= 0, d_hat > 0 (m); at
/// d = 0 the limits (inf, -inf, inf).
template <HasPotential S, class T>
BB_HD ShapeTerms<T> potential_terms(T d, T d_hat) {
  if (d >= d_hat) return {T(0), T(0), T(0)};
  const NormalizedGap<T> gap(d, d_hat);
  const ShapeTerms<T> b = S::eval(d, d_hat);
  const T u_sq = gap.u * gap.u;
  return {d_hat * d_hat * S::psi(gap), b.db / u_sq, (b.d2b - T(2) * b.db / d) / u_sq};
}

}  // namespace bb::shapes
