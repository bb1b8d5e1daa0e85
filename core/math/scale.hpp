// Powers of two as scale factors: dividing by them rounds nothing.
#pragma once

#include <cmath>

#include "core/math/types.hpp"

namespace bb {

/// The power of two in (m/2, m], m the largest |A_ij|; 1 for the zero matrix. Keeps squares of entries of A /
/// scale from over- and underflowing.   Host-device.
template <class T, int R, int C>
BB_HD inline T power_of_two_scale(const Mat<T, R, C>& A) {
  using std::abs, std::frexp, std::ldexp;
  T largest = 0;
  for (int j = 0; j < C; ++j) {
    for (int i = 0; i < R; ++i) largest = largest < abs(A(i, j)) ? abs(A(i, j)) : largest;
  }
  if (!(largest > 0)) return T(1);
  int exponent = 0;
  frexp(largest, &exponent);
  return ldexp(T(1), exponent - 1);
}

}  // namespace bb
