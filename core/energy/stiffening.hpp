// The energy of a deviation u whose stiffness grows exponentially: a linear and an exponential part.
#pragma once

#include <cmath>

#include "core/math/exp.hpp"
#include "core/math/host_device.hpp"

namespace bb {

/// w(u) with w' and w''.
template <class T>
struct Stiffened {
  T energy, slope, curvature;
};

/// e^y - 1 - y, y >= 0, without cancellation near 0. Host-device: yes.
template <class T>
BB_HD T exponential_remainder(T y) {
  using elementary::expm1;
  if (y > T(0.5)) return expm1(y) - y;
  T sum = T(0);  // y^2/2 (1 + y/3 (1 + y/4 (...))); the next factor is below 0.5^13 2/15!
  for (int k = 14; k >= 3; --k) sum = (T(1) + sum) * y / T(k);
  return y * y / T(2) * (T(1) + sum);
}

/// w = k/2 u^2 + q/a^2 (e^(a|u|) - 1 - a|u|): w' = k u + sign(u) q/a (e^(a|u|) - 1), w'' = k + q e^(a|u|). So k + q is the
/// stiffness at u = 0, and the part q grows e-fold every 1/a. k, q >= 0; a > 0 where q > 0 (in 1 over the unit of u). Host-device: yes.
/// Total; infinite beyond every number.
template <class T>
BB_HD Stiffened<T> stiffened(T u, T linear, T exponential, T exponent) {
  using elementary::exp, elementary::expm1, std::abs;
  Stiffened<T> out{linear / T(2) * u * u, linear * u, linear};
  if (!(exponential > T(0))) return out;
  const T y = exponent * abs(u), grown = exponential / exponent * expm1(y);
  out.energy += exponential / (exponent * exponent) * exponential_remainder(y);
  out.slope += u < T(0) ? -grown : grown;
  out.curvature += exponential * exp(y);
  return out;
}

}  // namespace bb
