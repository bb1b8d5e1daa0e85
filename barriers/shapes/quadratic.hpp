// The quadratic penalty on an interval. With e = 1 - d/d_hat:
//   b = (d - d_hat)^2 = d_hat^2 e^2,   b' = -2 d_hat e,   b'' = 2
//   at d_hat: 0, 0 and b'' jumps from 2 to 0;   at 0: d_hat^2, -2 d_hat, 2
// Source: Ando 2024 (cubic barrier), the quadratic it is compared with, in its corrected scale.
#pragma once

#include "core/barrier/shape_potential.hpp"

namespace bb::shapes {

struct Quadratic {
  static constexpr int smoothness_at_d_hat = 1;
  static constexpr bool infinite_at_zero = false;

  /// Requires d_hat > 0 (m); total.
  template <class T>
  BB_HD static ShapeTerms<T> eval(T d, T d_hat) {
    if (d >= d_hat) return {T(0), T(0), T(0)};
    const T e = NormalizedGap<T>(d, d_hat).e;
    return {d_hat * d_hat * (e * e), -d_hat * (T(2) * e), T(2)};
  }

  /// psi, the potential of b'/d^2: 2 (1/u - 1 + ln u) = (1/u - u + 2 ln u) + e^2/u, of which no term is negative.
  template <class T>
  BB_HD static T psi(const NormalizedGap<T>& gap) {
    return inverse_gap_excess(gap) + gap.e * gap.e / gap.u;
  }
};

}  // namespace bb::shapes
