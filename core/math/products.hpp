// Products without cancellation error: a*b - c*d and the cross product to the last bits, by fused
// multiply-add. Directions of thin triangles and of nearly touching edges are made of these.
#pragma once

#include <cmath>

#include "core/math/types.hpp"

namespace bb {

/// a*b - c*d within 1.5 ulp, barring under- and overflow.
/// Host-device.   Source: Kahan's algorithm; error bound by Jeannerod, Louvet, Muller 2013.
template <class T>
BB_HD inline T difference_of_products(T a, T b, T c, T d) {
  using std::fma;
  const T cd = c * d;
  const T rounding = fma(c, d, -cd);
  return fma(a, b, -cd) - rounding;
}

/// a x b, every component within 1.5 ulp, also for nearly parallel a and b.
/// Host-device.   Cost: 9 fused multiply-adds.
template <class T>
BB_HD inline Vec<T, 3> accurate_cross(const Vec<T, 3>& a, const Vec<T, 3>& b) {
  return Vec<T, 3>(difference_of_products(a[1], b[2], a[2], b[1]),
                   difference_of_products(a[2], b[0], a[0], b[2]),
                   difference_of_products(a[0], b[1], a[1], b[0]));
}

}  // namespace bb
