// Shared by the tests of this module: every registered shape on both arguments, and gaps spaced
// towards both ends.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "barriers/shapes/registry.hpp"

namespace bb::test {

inline std::vector<BarrierFunction> all_barriers() {
  std::vector<BarrierFunction> barriers;
  for (const Shape& shape : all_shapes()) {
    barriers.push_back({shape, Argument::gap});
    barriers.push_back({shape, Argument::squared_gap});
  }
  return barriers;
}

inline std::string label(const BarrierFunction& barrier) {
  return barrier.shape.name + " on " + std::string(to_string(barrier.argument));
}

inline BarrierFunction barrier(const char* shape, Argument argument = Argument::gap) {
  return {require_shape(shape), argument};
}

/// d/d_hat from `low` up to 1/2, and 1 - d/d_hat from `near` up to 1/2, `per_decade` to a factor of ten.
inline std::vector<double> spaced_u(double low, double near, int per_decade = 3) {
  std::vector<double> u;
  const double ratio = std::pow(10.0, 1.0 / per_decade);
  for (double x = low; x < 0.5; x *= ratio) u.push_back(x);
  for (double x = near; x < 0.5; x *= ratio) u.push_back(1 - x);
  return u;
}

inline double relative(double found, double expected) {
  return std::abs(found - expected) / std::abs(expected);
}

}  // namespace bb::test
