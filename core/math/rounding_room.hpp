// Which part of a Newton direction is rounding of the coordinates that it would change.
#pragma once

#include <cmath>

#include "core/math/types.hpp"

namespace bb {

/// Whether a displacement dx (m) of one coordinate of a vertex at x [3] is within rounding: 8 ulps of the vertex's own
/// largest coordinate or, near the origin, of `span`, the size of its body (m), since elements subtract coordinates of
/// its neighbours. epsilon: relative rounding of states. What other bodies have for coordinates does not count.
BB_HD inline bool within_coordinate_rounding(double dx, const double* x, double span, double epsilon) {
  using std::abs;
  double largest = span;
  for (int k = 0; k < 3; ++k) largest = abs(x[k]) > largest ? abs(x[k]) : largest;
  return abs(dx) <= 8 * epsilon * largest;
}

}  // namespace bb
