// The exponential function in + - * / and one fused multiply-add, which both compilers leave as they are written: libraries differ in
// the last place.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/math/host_device.hpp"

namespace bb::elementary {

/// 2^k, k in [-1022, 1023].
BB_HD inline double two_to(int k) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(k + 1023) << 52);
}

/// power (1 + r + r^2/2 + tail) - less within 1 ulp; the first three are summed without error.
BB_HD inline double sum_of_exp(double power, double r, double tail, double less) {
  const double half = 0.5 * r * r, half_lo = std::fma(0.5 * r, r, -half);
  const double base = power - less, first = base + power * r, second = first + power * half;
  const double rest =
      ((power - base) - less) + (power * r - (first - base)) + (power * half - (second - first));
  return second + (rest + power * (half_lo + tail));
}

/// exp(x) - less, less 0 or 1. With x = k ln 2 + r + c, |r| <= ln(2)/2, c what r lacks:
///   exp(x) = 2^k (1 + r + r^2/2 + c + r^3 (1/3! + r/4! + ...)),   11 terms of the last sum leave 1e-17
BB_HD inline double exp_less(double x, double less) {
  if (!(x < 710)) return x - x == 0 ? std::numeric_limits<double>::infinity() : x;
  if (x < -750) return 0 - less;
  constexpr double ln2_hi = 0x1.62e42feep-1, ln2_lo = 0x1.a39ef35793c76p-33;  // k ln2_hi is exact
  constexpr double per_ln2 = 0x1.71547652b82fep0, to_integer = 0x1.8p52;
  constexpr double part[] = {1. / 6,        1. / 24,        1. / 120,       1. / 720,
                             1. / 5040,     1. / 40320,     1. / 362880,    1. / 3628800,
                             1. / 39916800, 1. / 479001600, 1. / 6227020800};
  const double k = (x * per_ln2 + to_integer) - to_integer;
  const double whole = x - k * ln2_hi, lacks = k * ln2_lo, r = whole - lacks, c = (whole - r) - lacks;
  const double r_sq = r * r;
  double even = part[10], odd = part[9];  // two sums in r^2: neither waits for the other
  for (int j = 8; j >= 2; j -= 2) {
    even = even * r_sq + part[j];
    odd = odd * r_sq + part[j - 1];
  }
  even = even * r_sq + part[0];
  const double tail = c + r * r_sq * (even + r * odd);
  const int n = static_cast<int>(k);
  if (n >= -900 && n <= 1023) return sum_of_exp(two_to(n), r, tail, less);
  return sum_of_exp(1, r, tail, 0) * two_to(n / 2) * two_to(n - n / 2) - less;
}

/// exp(x) and exp(x) - 1, with the special values of std::exp and std::expm1. Host-device: yes. Total.
BB_HD inline double exp(double x) { return exp_less(x, 0); }
BB_HD inline double expm1(double x) { return x == 0 ? x : exp_less(x, 1); }
BB_HD inline float exp(float x) { return static_cast<float>(exp(static_cast<double>(x))); }
BB_HD inline float expm1(float x) { return static_cast<float>(expm1(static_cast<double>(x))); }
inline long double exp(long double x) { return std::exp(x); }
inline long double expm1(long double x) { return std::expm1(x); }

}  // namespace bb::elementary
