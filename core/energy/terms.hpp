// What every element energy returns, and whether its Hessian is the exact or the projected one.
#pragma once

#include "core/math/types.hpp"

namespace bb {

/// none: the exact second derivative. psd: its negative eigenvalues set to 0 (membranes and strain limiting:
/// those of d2psi/dF2, before the constant chain rule to the vertices; springs and hinges: those of the whole
/// matrix).
enum class Projection { none, psd };

/// Terms of one element; N = 3 x number of points, point-major.
template <class T, int N>
struct ElementTerms {
  T energy;           // J
  Vec<T, N> grad;     // N
  Mat<T, N, N> hess;  // N/m, symmetric bit for bit
};

}  // namespace bb
