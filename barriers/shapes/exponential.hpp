// The exponential barrier, whose force grows by a factor e for every d_hat/a that the gap shrinks. With
// e = 1 - d/d_hat, t = a e, a the exponent, and p_k(t) = exp(t) - 1 - t - ... - t^(k-1)/(k-1)!, that is
// p_1 = exp(t) - 1, p_2 = p_1 - t, p_3 = p_2 - t^2/2:
//   b = d_hat^2 p_3/(a exp(a)),   b' = -d_hat p_2/exp(a),   b'' = a p_1/exp(a)
//   at d_hat: 0, 0, 0 (b''' jumps by a^2/exp(a));   at 0: finite, b' -> -(1 - (1 + a) exp(-a)) d_hat
// So it is C2 at d_hat and carries at most (1 - (1 + a) exp(-a)) kappa d_hat. rho = d_hat b''/|b'| is 2/e at d_hat,
// as the cubic's, and a deep inside: what a load costs in stiffness does not grow with depth.
// Source: ours, derived in this project (docs/theory/barriers.md, Shapes and arguments).
#pragma once

#include "core/barrier/normalized_gap.hpp"
#include "core/math/exp.hpp"

namespace bb::shapes {

struct Exponential {
  static constexpr int smoothness_at_d_hat = 2;
  static constexpr bool infinite_at_zero = false;
  /// Exponents that are allowed, and the one of the plain name. Below, it is the cubic but for its scale; above, no gap
  /// differs from the exponential itself, and a float cannot represent it.
  static constexpr double least_exponent = 0.5, most_exponent = 40, default_exponent = 6;

  /// Requires d_hat > 0 (m) and an allowed exponent a; total.
  template <class T>
  BB_HD static ShapeTerms<T> eval(T d, T d_hat, T a = T(default_exponent)) {
    if (d >= d_hat) return {T(0), T(0), T(0)};
    const T t = a * NormalizedGap<T>(d, d_hat).e, at_d_hat = elementary::exp(-a);
    T p1, p2, p3;
    if (t < T(1)) {
      p3 = third_remainder(t);
      p2 = p3 + T(0.5) * (t * t);
      p1 = p2 + t;
    } else {
      p1 = elementary::exp(t) - T(1);
      p2 = p1 - t;
      p3 = p2 - T(0.5) * (t * t);
    }
    return {d_hat * d_hat * (at_d_hat * p3 / a), -d_hat * (at_d_hat * p2), a * (at_d_hat * p1)};
  }

 private:
  /// p_3 for t < 1, summed: t^3/6 (1 + t/4 (1 + t/5 (...))), of which 16 terms leave 1e-17.
  template <class T>
  BB_HD static T third_remainder(T t) {
    T sum = T(1);
    for (int k = 19; k >= 4; --k) sum = T(1) + t / T(k) * sum;
    return t * t * t / T(6) * sum;
  }
};

}  // namespace bb::shapes
