// The shapes `minimax` and `minimax_bounded` in long double, from the integrals of their forces added up from d_hat.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/barrier/shape.hpp"

namespace bb::test {

/// b, b', b'' at d_hat = 1 and the gap u < 1, of the exponent a.
inline ShapeTerms<long double> minimax_terms(long double a, long double u, bool infinite_at_zero) {
  using Real = long double;
  const Real c = std::exp(Real(2.5) - a), tail = infinite_at_zero ? 1 / a : 0;
  const Real t = a * (1 - u), inside = a * (1 - std::max(u, tail));
  Real b = c * std::pow(std::min(inside, Real(1)), 3) / 6;
  if (inside > 1) b += c * (std::pow(std::min(inside, Real(1.5)) - Real(0.5), 2) - Real(0.25)) / 2;
  if (inside > 1.5) b += c * std::expm1(inside - Real(1.5));
  if (u < tail) return {(b - std::log(a * u)) / a, -1 / (a * u), 1 / (a * u * u)};
  const Real force = t <= 1 ? c * t * t / 2 : t <= 1.5 ? c * (t - Real(0.5)) : std::exp(1 - a * u);
  const Real slope = t <= 1 ? c * t : t <= 1.5 ? c : force;
  return {b / a, -force, a * slope};
}

}  // namespace bb::test
