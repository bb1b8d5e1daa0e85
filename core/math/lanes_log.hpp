// The logarithm (log.hpp) of four numbers side by side, with the bits of that of one.
#pragma once

#include "core/math/lanes.hpp"
#include "core/math/log.hpp"

namespace bb::elementary {

template <>
struct Bits<Lanes<double, 4>> {
  using Vector = VectorOf<std::uint64_t, 4>::type;
  static Vector of(const Lanes<double, 4>& x) { return reinterpret_cast<Vector>(x.v); }
  static Lanes<double, 4> number(const Vector& bits) {
    return reinterpret_cast<Lanes<double, 4>::Vector>(bits);
  }
};

}  // namespace bb::elementary
