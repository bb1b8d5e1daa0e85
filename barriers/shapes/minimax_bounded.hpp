// The barrier whose largest relative stiffness over a range of loads is least, finite at contact. With u = d/d_hat,
// t = a (1 - u), a the exponent, and c = exp(5/2 - a), the force grows with t^2 at first, then with t, then
// exponentially:
//   t <= 1:    b = d_hat^2 c t^3/(6 a),                    b' = -d_hat c t^2/2,         b'' = a c t
//   t <= 3/2:  b = d_hat^2 c (t^2/2 - t/2 + 1/6)/a,        b' = -d_hat c (t - 1/2),     b'' = a c
//   above:     b = d_hat^2 (exp(1 - a u) - 11 c/24)/a,     b' = -d_hat exp(1 - a u),    b'' = a exp(1 - a u)
//   at d_hat: 0, 0, 0 (b''' jumps by a^2 c/d_hat);   at 0: finite, b' = -e d_hat
// So it is C2 and carries at most e kappa d_hat. A load f of at least c kappa d_hat rests at u <= 1 - 3/(2 a), where the
// stiffness of the contact is a f/d_hat.
// Source: ours, derived in this project (docs/theory/load-ranges.md).
#pragma once

#include <array>

#include "core/barrier/normalized_gap.hpp"
#include "core/math/exp.hpp"

namespace bb::shapes {

struct MinimaxBounded {
  static constexpr int smoothness_at_d_hat = 2;
  static constexpr bool infinite_at_zero = false;
  /// Exponents that are allowed, and that of the plain name, which is for loads of a ratio of 100 (5/2 + ln 100).
  static constexpr double least_exponent = 3, most_exponent = 40, default_exponent = 7;

  /// u where t is 1 and 3/2.
  static std::array<double, 2> joints(double a) { return {1 - 1 / a, 1 - 1.5 / a}; }

  /// Requires d_hat > 0 (m) and an allowed exponent a; total.
  template <class T>
  BB_HD static ShapeTerms<T> eval(T d, T d_hat, T a = T(default_exponent)) {
    if (d >= d_hat) return {T(0), T(0), T(0)};
    const NormalizedGap<T> gap(d, d_hat);
    const T t = a * gap.e, c = elementary::exp(T(2.5) - a), area = d_hat * d_hat / a;
    if (t <= T(1)) return {area * (c * (t * t * t / T(6))), -d_hat * (c * (T(0.5) * (t * t))), a * (c * t)};
    if (t <= T(1.5)) {
      return {area * (c * (T(0.5) * t * (t - T(1)) + T(1) / T(6))), -d_hat * (c * (t - T(0.5))), a * c};
    }
    const T force = elementary::exp(T(1) - a * gap.u);
    return {area * (force - T(11) / T(24) * c), -d_hat * force, a * force};
  }
};

}  // namespace bb::shapes
