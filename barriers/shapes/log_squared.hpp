// The squared-logarithm barrier. With u = d/d_hat, e = 1 - u, l = -ln u, r = e/u:
//   b = (d - d_hat)^2 ln^2(d/d_hat) = d_hat^2 e^2 l^2,   b' = -2 d_hat e l (l + r),
//   b'' = 2 l^2 + 8 r l + 2 r^2 (1 + l)
//   at d_hat: 0, 0, 0, also b''' (the fourth derivative jumps);   at 0: b -> inf, b' -> -inf, b'' -> inf
// Source: Huang et al. 2024 (GIPC), there on the squared gap.
#pragma once

#include "core/barrier/normalized_gap.hpp"

namespace bb::shapes {

struct LogSquared {
  static constexpr int smoothness_at_d_hat = 3;
  static constexpr bool infinite_at_zero = true;

  /// Requires d >= 0, d_hat > 0 (m); total there.
  template <class T>
  BB_HD static ShapeTerms<T> eval(T d, T d_hat) {
    if (d >= d_hat) return {T(0), T(0), T(0)};
    const NormalizedGap<T> gap(d, d_hat);
    return terms(gap, d_hat, gap.minus_log());
  }
  /// The same below d_hat, l known.
  template <class T>
  BB_HD static ShapeTerms<T> terms(const NormalizedGap<T>& gap, T d_hat, T l) {
    const T e = gap.e, r = e / gap.u, el = e * l;
    return {d_hat * d_hat * (el * el), -d_hat * (T(2) * el * (l + r)),
            T(2) * (l * l + T(4) * r * l + r * r * (T(1) + l))};
  }
};

}  // namespace bb::shapes
