// Directions that a user hands in at any size.
#pragma once

#include <cmath>

#include "core/math/types.hpp"

namespace bb {

/// The same direction, exactly, where squares of its components would leave double: then its largest component is in [1, 2).
/// Precondition: not 0, finite.
inline Vec3d of_usual_size(const Vec3d& direction) {
  const double largest = direction.cwiseAbs().maxCoeff();
  if (largest > 1e-100 && largest < 1e100) return direction;
  const int k = std::ilogb(largest);
  return direction.unaryExpr([k](double x) { return std::ldexp(x, -k); });
}

}  // namespace bb
