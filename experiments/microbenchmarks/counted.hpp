// Floating-point operations of an element function, counted by a scalar that counts: sums, products, quotients and square roots
// are 1, a fused multiply-add 2; signs, comparisons and choices are 0.
#pragma once

#include <cmath>
#include <limits>

#include "core/math/select.hpp"
#include "core/math/types.hpp"

namespace bb::bench {

struct Counted {
  double v = 0;
  static inline long long flops = 0;  // on one thread

  Counted() = default;
  Counted(double number) : v(number) {}  // NOLINT(google-explicit-constructor): literals of element functions
  static Counted made(double number, int of) {
    flops += of;
    return {number};
  }
  friend Counted operator+(Counted a, Counted b) { return made(a.v + b.v, 1); }
  friend Counted operator-(Counted a, Counted b) { return made(a.v - b.v, 1); }
  friend Counted operator*(Counted a, Counted b) { return made(a.v * b.v, 1); }
  friend Counted operator/(Counted a, Counted b) { return made(a.v / b.v, 1); }
  Counted operator-() const { return {-v}; }
  Counted& operator+=(Counted b) { return *this = *this + b; }
  Counted& operator-=(Counted b) { return *this = *this - b; }
  Counted& operator*=(Counted b) { return *this = *this * b; }
  Counted& operator/=(Counted b) { return *this = *this / b; }
  friend bool operator<(Counted a, Counted b) { return a.v < b.v; }
  friend bool operator>(Counted a, Counted b) { return a.v > b.v; }
  friend bool operator<=(Counted a, Counted b) { return a.v <= b.v; }
  friend bool operator==(Counted a, Counted b) { return a.v == b.v; }
  friend bool operator!=(Counted a, Counted b) { return a.v != b.v; }

  friend Counted sqrt(Counted a) { return made(std::sqrt(a.v), 1); }
  friend Counted fma(Counted a, Counted b, Counted c) { return made(std::fma(a.v, b.v, c.v), 2); }
  friend Counted abs(Counted a) { return {std::abs(a.v)}; }
  friend Counted frexp(Counted a, int* exponent) { return {std::frexp(a.v, exponent)}; }
  friend Counted ldexp(Counted a, int exponent) { return {std::ldexp(a.v, exponent)}; }
};

/// Operations of f(), on average over n calls f(i).
template <class F>
double flops_of(std::size_t n, const F& f) {
  Counted::flops = 0;
  for (std::size_t i = 0; i < n; ++i) f(i);
  return static_cast<double>(Counted::flops) / static_cast<double>(n);
}

}  // namespace bb::bench

template <>
struct bb::ScalarOf<bb::bench::Counted> {
  using type = double;
};
template <>
class std::numeric_limits<bb::bench::Counted> : public std::numeric_limits<double> {};
template <>
struct Eigen::NumTraits<bb::bench::Counted> : Eigen::GenericNumTraits<double> {
  using Real = bb::bench::Counted;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = Real;
  enum { RequireInitialization = 1 };
};
