// W numbers that are computed side by side, so that an element function templated on its scalar runs for W
// elements at the price of little more than one. No lane depends on another, and Eigen adds as it does for plain numbers
// (EIGEN_DONT_VECTORIZE), so that a lane has the numbers of the scalar code; abs() here keeps the sign of a zero.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

#include "core/math/scale.hpp"
#include "core/math/select.hpp"
#include "core/math/types.hpp"

namespace bb {

template <class T, int W>
struct VectorOf {
  typedef T type __attribute__((vector_size(W * sizeof(T))));
};

/// One truth value a lane; bits of a lane all set or all clear.
template <class T, int W>
struct LaneMask {
  using Vector = typename VectorOf<T, W>::type;
  using Bits = decltype(Vector() < Vector());
  Bits bits;

  LaneMask() : bits{} {}
  LaneMask(Bits b) : bits(b) {}
  LaneMask(bool b) : bits(b ? ~Bits{} : Bits{}) {}
  LaneMask operator&&(const LaneMask& other) const { return bits & other.bits; }
  LaneMask operator||(const LaneMask& other) const { return bits | other.bits; }
  LaneMask operator!() const { return ~bits; }
};

template <class T, int W>
struct Lanes {
  using Vector = typename VectorOf<T, W>::type;
  using Mask = LaneMask<T, W>;
  Vector v;

  Lanes() = default;
  Lanes(Vector lanes) : v(lanes) {}
  Lanes(T all) : v(all - Vector{}) {}
  T operator[](int lane) const { return v[lane]; }

  friend Lanes operator+(const Lanes& a, const Lanes& b) { return a.v + b.v; }
  friend Lanes operator-(const Lanes& a, const Lanes& b) { return a.v - b.v; }
  friend Lanes operator*(const Lanes& a, const Lanes& b) { return a.v * b.v; }
  friend Lanes operator/(const Lanes& a, const Lanes& b) { return a.v / b.v; }
  Lanes operator-() const { return -v; }
  Lanes& operator+=(const Lanes& b) { return *this = *this + b; }
  Lanes& operator-=(const Lanes& b) { return *this = *this - b; }
  Lanes& operator*=(const Lanes& b) { return *this = *this * b; }
  Lanes& operator/=(const Lanes& b) { return *this = *this / b; }

  /// std::fma, lane by lane.
  friend Lanes fma(const Lanes& a, const Lanes& b, const Lanes& c) {
#if defined(__AVX__) && defined(__FMA__)
    if constexpr (std::is_same_v<T, double> && W == 4) return __builtin_ia32_vfmaddpd256(a.v, b.v, c.v);
#endif
    Lanes out;
    for (int lane = 0; lane < W; ++lane) out.v[lane] = std::fma(a.v[lane], b.v[lane], c.v[lane]);
    return out;
  }

  friend Mask operator<(const Lanes& a, const Lanes& b) { return Mask(a.v < b.v); }
  friend Mask operator>(const Lanes& a, const Lanes& b) { return Mask(a.v > b.v); }
  friend Mask operator<=(const Lanes& a, const Lanes& b) { return Mask(a.v <= b.v); }
  friend Mask operator==(const Lanes& a, const Lanes& b) { return Mask(a.v == b.v); }
};

template <class T, int W>
struct ScalarOf<Lanes<T, W>> {
  using type = T;
};

/// The W numbers from `column` on.
template <int W, class T>
Lanes<T, W> load_lanes(const T* column) {
  Lanes<T, W> out;
  std::memcpy(&out.v, column, sizeof(out.v));
  return out;
}
template <class T, int W>
void store_lanes(const Lanes<T, W>& x, T* column) {
  std::memcpy(column, &x.v, sizeof(x.v));
}

template <class T, int W>
Lanes<T, W> select(const LaneMask<T, W>& mask, const Lanes<T, W>& yes, const Lanes<T, W>& no) {
  return mask.bits ? yes.v : no.v;
}
template <class T, int W>
bool any(const LaneMask<T, W>& mask) {
#if defined(__AVX__)
  if constexpr (sizeof(mask.bits) == 32) {
    const auto words = std::bit_cast<typename VectorOf<long long, 4>::type>(mask.bits);
    return __builtin_ia32_ptestz256(words, words) == 0;
  }
#endif
  constexpr std::size_t n = sizeof(mask.bits) / sizeof(std::uint64_t);
  std::uint64_t words[n], out = 0;
  std::memcpy(words, &mask.bits, sizeof(words));
  for (std::size_t k = 0; k < n; ++k) out |= words[k];
  return out != 0;
}

template <class T, int W>
Lanes<T, W> sqrt(const Lanes<T, W>& a) {
#if defined(__AVX__)
  if constexpr (std::is_same_v<T, double> && W == 4) return __builtin_ia32_sqrtpd256(a.v);
#endif
  Lanes<T, W> out;
  for (int lane = 0; lane < W; ++lane) out.v[lane] = std::sqrt(a.v[lane]);
  return out;
}
template <class T, int W>
Lanes<T, W> abs(const Lanes<T, W>& a) {
  return select(a < Lanes<T, W>(T(0)), -a, a);
}

/// Lane by lane, as for a scalar. Without a call a lane: the bits of infinity are those that hold an exponent.
template <class T, int W>
Lanes<T, W> power_of_two_below(const Lanes<T, W>& a) {
  using Real = Lanes<T, W>;
  using Bits = typename LaneMask<T, W>::Bits;
  const Real infinity(std::numeric_limits<T>::infinity()), least(least_scale<T>);
  const Bits exponent = std::bit_cast<Bits>(a.v) & std::bit_cast<Bits>(infinity.v);
  const Real power(std::bit_cast<typename Real::Vector>(exponent));
  return select(a > Real(T(0)), select(power > least, power, least), Real(T(1)));
}

}  // namespace bb

template <class T, int W>
struct Eigen::NumTraits<bb::Lanes<T, W>> : Eigen::GenericNumTraits<T> {
  using Real = bb::Lanes<T, W>;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = Real;
  enum { RequireInitialization = 0 };
};
