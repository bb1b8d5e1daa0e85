// What is done to the negative eigenvalues of a small symmetric matrix, an element's or a contact's Hessian.
#pragma once

#include "core/math/select.hpp"
#include "core/math/types.hpp"

namespace bb {

/// none: the exact matrix. psd: negative eigenvalues become 0 ("clamped"). absolute: they change their sign
/// (Chen et al. 2024, Stabler Neo-Hookean Simulation).
enum class Projection { none, psd, absolute };

/// The eigenvalue that takes the place of `value`. Host-device, lanes.
template <class T>
BB_HD inline T project_eigenvalue(T value, Projection projection) {
  if (projection == Projection::none) return value;
  return select(value < T(0), projection == Projection::psd ? T(0) : -value, value);
}

}  // namespace bb
