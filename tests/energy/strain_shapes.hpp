// Two stand-in shapes for the strain limit tests: their own formulas, as calls on one gap and as a batch.
#pragma once

#include <cmath>
#include <cstddef>

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

/// The batch call of a barrier function, for any stand-in.
template <class Shape>
struct BatchOf {
  void eval(std::size_t n, const double* y, const double* width, double* b, double* db, double* d2b) const {
    for (std::size_t i = 0; i < n; ++i) {
      const auto terms = Shape{}(y[i], width[i]);
      b[i] = terms.b;
      db[i] = terms.db;
      d2b[i] = terms.d2b;
    }
  }
};

}  // namespace bb::test
