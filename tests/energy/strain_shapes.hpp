// Two stand-in shapes for the strain limit tests: their own formulas.
#pragma once

#include <cmath>

namespace bb::test {

template <class T>
struct StandInTerms {
  T b, db, d2b;
};

struct QuadraticStandIn {
  template <class T>
  StandInTerms<T> operator()(T y, T width) const {
    if (y >= width) return {0, 0, 0};
    return {(y - width) * (y - width), 2 * (y - width), 2};
  }
};

struct LogStandIn {
  template <class T>
  StandInTerms<T> operator()(T y, T width) const {
    if (y >= width) return {0, 0, 0};
    const T s = y - width, log_ratio = std::log(y / width);
    return {-s * s * log_ratio, -2 * s * log_ratio - s * s / y, -2 * log_ratio - 4 * s / y + s * s / (y * y)};
  }
};

}  // namespace bb::test
