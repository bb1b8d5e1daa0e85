// The barrier whose largest relative stiffness over a range of loads is least, infinite at contact: `minimax_bounded`
// down to the gap d_hat/a, and below it a force that grows with 1/d. With u = d/d_hat, a the exponent, c = exp(5/2 - a):
//   a u < 1:   b = d_hat^2 (1 - 11 c/24 - ln(a u))/a,   b' = -d_hat/(a u),   b'' = 1/(a u^2)
//   at the joint a u = 1: b' = -d_hat, b'' = a, as from above;   at 0: inf, -inf, inf
// So it is C2 everywhere. With a = 5/2 + ln r, loads from c kappa d_hat to r c kappa d_hat rest at and above the joint.
// Source: ours, derived in this project (docs/theory/load-ranges.md).
#pragma once

#include <array>

#include "barriers/shapes/minimax_bounded.hpp"
#include "core/math/log.hpp"

namespace bb::shapes {

struct Minimax {
  static constexpr int smoothness_at_d_hat = 2;
  static constexpr bool infinite_at_zero = true;
  static constexpr double least_exponent = MinimaxBounded::least_exponent,
                          most_exponent = MinimaxBounded::most_exponent,
                          default_exponent = MinimaxBounded::default_exponent;

  static std::array<double, 3> joints(double a) { return {1 - 1 / a, 1 - 1.5 / a, 1 / a}; }

  /// Requires d >= 0, d_hat > 0 (m) and an allowed exponent a; total there.
  template <class T>
  BB_HD static ShapeTerms<T> eval(T d, T d_hat, T a = T(default_exponent)) {
    const T u = d / d_hat, au = a * u;
    const bool below = au < T(1);
    ShapeTerms<T> out = MinimaxBounded::eval(below ? d_hat / a : d, d_hat, a);
    if (below) {
      out.b -= d_hat * d_hat / a * elementary::log(au);
      out.db = -d_hat / au;
      out.d2b = T(1) / (au * u);
    }
    return out;
  }
};

}  // namespace bb::shapes
