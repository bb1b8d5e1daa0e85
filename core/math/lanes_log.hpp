// The logarithm of four numbers side by side.
#pragma once

#include <cstdint>

#include "core/math/lanes.hpp"

namespace bb {

/// -ln u for u in (2^-1000, 1], to a few ulps, also where u is so close to 1 that only e = 1 - u tells how close. With
/// u = 2^k m, m between the roots of 1/2 and 2, and s = (m - 1)/(m + 1):
///   ln u = k ln 2 + 2 atanh s,   atanh s = s + s^3/3 + s^5/5 + ...,   s^2 < 0.03: 11 terms leave 1e-18
inline Lanes<double, 4> minus_log(const Lanes<double, 4>& u, const Lanes<double, 4>& e) {
  using Real = Lanes<double, 4>;
  using Bits = VectorOf<std::uint64_t, 4>::type;
  constexpr std::uint64_t root_half = 0x3fe6a09e667f3bcd, two_pow_52 = 0x4330000000000000, bias = 2048;
  constexpr double ln2_hi = 0x1.62e42feep-1, ln2_lo = 0x1.a39ef35793c76p-33;  // k ln2_hi is exact
  const Bits bits = reinterpret_cast<Bits>(u.v);
  const Bits exponent = (bits - root_half + (bias << 52)) >> 52;  // k + bias
  const Real m = reinterpret_cast<Real::Vector>(bits - (exponent << 52) + (bias << 52));
  const Real k = Real(reinterpret_cast<Real::Vector>(exponent | two_pow_52)) - Real(0x1p52 + bias);
  const Real f = select(k == Real(0), -e, m - Real(1));
  const Real s = f / (Real(2) + f), z = s * s;
  constexpr double part[] = {2. / 3,  2. / 5,  2. / 7,  2. / 9,  2. / 11,
                             2. / 13, 2. / 15, 2. / 17, 2. / 19, 2. / 21};
  const Real z_sq = z * z;
  Real even = part[8], odd = part[9];  // two sums in z^2: neither waits for the other
  for (std::size_t j : {6u, 4u, 2u, 0u}) {
    even = even * z_sq + Real(part[j]);
    odd = odd * z_sq + Real(part[j + 1]);
  }
  const Real sum = (even + z * odd) * z;
  return -(k * Real(ln2_hi) + (Real(2) * s + (s * sum + k * Real(ln2_lo))));
}

}  // namespace bb
