// The natural logarithm in + - * /, which both compilers leave as they are written: libraries differ in the last place.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/math/host_device.hpp"
#include "core/math/select.hpp"

namespace bb::elementary {

/// The bits of a number, or of several side by side (lanes_log.hpp), and the number that has them.
template <class Real>
struct Bits;
template <>
struct Bits<double> {
  BB_HD static std::uint64_t of(double x) { return std::bit_cast<std::uint64_t>(x); }
  BB_HD static double number(std::uint64_t bits) { return std::bit_cast<double>(bits); }
};

/// x = 2^k m, m between the roots of 1/2 and 2.
template <class Real>
struct Binary {
  Real k, m;
};
/// Of a normal x > 0.
template <class Real>
BB_HD Binary<Real> in_binary(const Real& x) {
  constexpr std::uint64_t root_half = 0x3fe6a09e667f3bcd, two_pow_52 = 0x4330000000000000, bias = 2048;
  const auto bits = Bits<Real>::of(x);
  const auto exponent = (bits - root_half + (bias << 52)) >> 52;  // k + bias
  return {Bits<Real>::number(exponent | two_pow_52) - Real(0x1p52 + bias),
          Bits<Real>::number(bits - (exponent << 52) + (bias << 52))};
}

/// k ln 2 + ln(1 + f), 1 + f between the roots of 1/2 and 2, within 1 ulp where k and f are exact. With s = f/(2 + f):
///   ln(1 + f) = 2 atanh s = 2 s + 2 s^3/3 + 2 s^5/5 + ...,   s^2 < 0.03: 11 terms leave 1e-18
/// and 2 s = f - f^2/2 + s f^2/2, of which f is exact.
template <class Real>
BB_HD Real log_of(const Real& k, const Real& f) {
  constexpr double ln2_hi = 0x1.62e42feep-1, ln2_lo = 0x1.a39ef35793c76p-33;  // k ln2_hi is exact
  constexpr double part[] = {2. / 3,  2. / 5,  2. / 7,  2. / 9,  2. / 11,
                             2. / 13, 2. / 15, 2. / 17, 2. / 19, 2. / 21};
  const Real s = f / (Real(2) + f), z = s * s, z_sq = z * z;
  Real even = part[8], odd = part[9];  // two sums in z^2: neither waits for the other
  for (int j = 6; j >= 0; j -= 2) {
    even = even * z_sq + Real(part[j]);
    odd = odd * z_sq + Real(part[j + 1]);
  }
  const Real half = Real(0.5) * f * f, sum = (even + z * odd) * z;
  return k * Real(ln2_hi) + (f - (half - (s * (half + sum) + k * Real(ln2_lo))));
}

/// ln x, with the special values of std::log. Host-device: yes. Total.
BB_HD inline double log(double x) {
  double shift = 0;
  if (!(x >= std::numeric_limits<double>::min())) {
    if (x == 0) return -std::numeric_limits<double>::infinity();
    if (!(x > 0)) return std::numeric_limits<double>::quiet_NaN();
    x *= 0x1p54, shift = 54;
  }
  if (x > std::numeric_limits<double>::max()) return x;
  const Binary<double> of = in_binary(x);
  return log_of(of.k - shift, of.m - 1);
}
BB_HD inline float log(float x) { return static_cast<float>(log(static_cast<double>(x))); }
inline long double log(long double x) { return std::log(x); }

/// -ln u, where u > 2^-1022 and e = 1 - u, of which e is the more exact one where u is close to 1. Host-device: yes. Lanes: yes.
template <class Real>
BB_HD Real minus_log_of(const Real& u, const Real& e) {
  const Binary<Real> of = in_binary(u);
  return -log_of<Real>(of.k, select(of.k == Real(0), -e, of.m - Real(1)));
}
/// The same for all u. Host-device: yes. Total.
BB_HD inline double minus_log(double u, double e) {
  const bool ordinary = u >= std::numeric_limits<double>::min() && u <= std::numeric_limits<double>::max();
  return ordinary ? minus_log_of(u, e) : -log(u);
}
BB_HD inline float minus_log(float u, float e) {
  return static_cast<float>(minus_log(static_cast<double>(u), static_cast<double>(e)));
}
inline long double minus_log(long double u, long double e) {
  return e < 0.5L ? -std::log1p(-e) : -std::log(u);
}

}  // namespace bb::elementary
