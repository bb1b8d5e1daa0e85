// Powers of two as scale factors: dividing by them rounds nothing.
#pragma once

#include <cmath>
#include <limits>

#include "core/math/select.hpp"
#include "core/math/types.hpp"

namespace bb {

/// The smallest scale factor: the inverse of a smaller one might overflow.
template <class T>
inline constexpr T least_scale = 8 * std::numeric_limits<T>::min();

/// The power of two in (m/2, m] for a finite m > 0, 1 for 0; at least least_scale. Host-device.
template <class T>
BB_HD inline T power_of_two_below(T m) {
  using std::frexp, std::ldexp;
  if (!(m > 0)) return T(1);
  int exponent = 0;
  frexp(m, &exponent);
  constexpr typename ScalarOf<T>::type least = least_scale<typename ScalarOf<T>::type>;
  const T power = ldexp(T(1), exponent - 1);
  return power > T(least) ? power : T(least);
}

/// The power of two in (m/2, m], m the largest |A_ij|; 1 for the zero matrix. Keeps squares of entries of A /
/// scale from over- and underflowing.   Host-device.
template <class T, int R, int C>
BB_HD inline T power_of_two_scale(const Mat<T, R, C>& A) {
  using std::abs;
  T largest(0);
  for (int j = 0; j < C; ++j) {
    for (int i = 0; i < R; ++i) largest = select(largest < abs(A(i, j)), abs(A(i, j)), largest);
  }
  return power_of_two_below(largest);
}

}  // namespace bb
