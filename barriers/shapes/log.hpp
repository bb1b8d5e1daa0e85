// The logarithmic barrier in the gap. With u = d/d_hat, e = 1 - u, l = -ln u, r = e/u:
//   b = -(d - d_hat)^2 ln(d/d_hat) = d_hat^2 e^2 l,   b' = -d_hat e (2 l + r),   b'' = 2 l + 4 r + r^2
//   at d_hat: 0, 0, 0 (b''' jumps);   at 0: b -> inf, b' -> -inf, b'' -> inf
// Source: Li et al. 2020 (IPC), there on the squared gap; on the gap in Li et al. 2021 (C-IPC).
#pragma once

#include "core/barrier/normalized_gap.hpp"

namespace bb::shapes {

struct Log {
  static constexpr int smoothness_at_d_hat = 2;
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
    const T e = gap.e, r = e / gap.u;
    return {d_hat * d_hat * (e * e * l), -d_hat * (e * (T(2) * l + r)), T(2) * l + T(4) * r + r * r};
  }
};

}  // namespace bb::shapes
