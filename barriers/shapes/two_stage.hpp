// The two-stage barrier: quadratic above d_hat/2, logarithmic below, C2 at the joint. With u = d/d_hat,
// e = 1 - u:
//   u >= 1/2: b = d_hat^2 e^2,                      b' = -2 d_hat e,      b'' = 2
//   u <  1/2: b = d_hat^2 (1/4 - ln(2 u)/2),        b' = -d_hat/(2 u),    b'' = 1/(2 u^2)
//   at the joint: d_hat^2/4, -d_hat, 2;   at d_hat: 0, 0 and b'' jumps from 2 to 0;   at 0: inf, -inf, inf
// Source: Chen et al. 2025 (offset geometric contact), activation function; twice the scale of IPC Toolkit's.
#pragma once

#include "core/barrier/normalized_gap.hpp"

namespace bb::shapes {

struct TwoStage {
  static constexpr int smoothness_at_d_hat = 1;
  static constexpr bool infinite_at_zero = true;

  /// Requires d >= 0, d_hat > 0 (m); total there.
  template <class T>
  BB_HD static ShapeTerms<T> eval(T d, T d_hat) {
    using elementary::log;
    if (d >= d_hat) return {T(0), T(0), T(0)};
    const NormalizedGap<T> gap(d, d_hat);
    const T e = gap.e, two_u = T(2) * gap.u;
    if (two_u >= T(1)) return {d_hat * d_hat * (e * e), -d_hat * (T(2) * e), T(2)};
    const T inverse = T(1) / two_u;
    return {d_hat * d_hat * (T(0.25) - T(0.5) * log(two_u)), -d_hat * inverse, T(2) * inverse * inverse};
  }
};

}  // namespace bb::shapes
