// The cubic barrier. With e = 1 - d/d_hat:
//   b = 2/(3 d_hat) (d_hat - d)^3 = 2/3 d_hat^2 e^3,   b' = -2 d_hat e^2,   b'' = 4 e
//   at d_hat: 0, 0, 0 (b''' jumps);   at 0: 2/3 d_hat^2, -2 d_hat, 4
// Source: Ando 2024, "A Cubic Barrier with Elasticity-Inclusive Dynamic Stiffness".
#pragma once

#include "core/barrier/shape_potential.hpp"

namespace bb::shapes {

struct Cubic {
  static constexpr int smoothness_at_d_hat = 2;
  static constexpr bool infinite_at_zero = false;

  /// Requires d_hat > 0 (m); total.
  template <class T>
  BB_HD static ShapeTerms<T> eval(T d, T d_hat) {
    if (d >= d_hat) return {T(0), T(0), T(0)};
    const T e = NormalizedGap<T>(d, d_hat).e;
    return {d_hat * d_hat * (T(2) / T(3) * (e * e * e)), -d_hat * (T(2) * e * e), T(4) * e};
  }

  /// psi, the potential of b'/d^2: 2 (1/u - u + 2 ln u).
  template <class T>
  BB_HD static T psi(const NormalizedGap<T>& gap) {
    return T(2) * inverse_gap_excess(gap);
  }
};

}  // namespace bb::shapes
