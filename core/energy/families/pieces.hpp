// Which elements of a family give local terms at a time, and for which Hessian.
#pragma once

#include "core/exec/kernel.hpp"
#include "core/math/projection.hpp"

namespace bb {

/// Neighbouring elements of a family: what has local terms at a time.
struct Piece {
  exec::Index begin, n;
};

/// Which Hessian of an element goes into the matrix: `first`; where t > 0, first + t (clamped - first); where a vertex
/// of the element has a force of at least `threshold`, the clamped one.
struct HessianRequest {
  Projection first = Projection::psd;
  double t = 0;
  double threshold = -1;          // N; below 0: no vertex is compared
  const double* force = nullptr;  // [n_vertices] N, read where there is a threshold
};

}  // namespace bb
