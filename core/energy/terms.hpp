// What every element energy returns, and whether its Hessian is the exact or the projected one.
#pragma once

#include "core/math/types.hpp"

namespace bb {

/// none: the exact second derivative. psd: its negative eigenvalues set to 0 (membranes and strain
/// limiting: those of d2psi/dF2, before the constant chain rule to the vertices; springs and hinges: those
/// of the whole matrix).
enum class Projection { none, psd };

/// Makes `m` symmetric bit for bit: its lower triangle is copied to the upper one.
template <class T, int N>
BB_HD void mirror_lower(Mat<T, N, N>& m) {
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < i; ++j) m(j, i) = m(i, j);
  }
}

/// Terms of one element; N = 3 x number of points, point-major.
template <class T, int N>
struct ElementTerms {
  T energy;           // J
  Vec<T, N> grad;     // N
  Mat<T, N, N> hess;  // N/m, symmetric bit for bit
};

}  // namespace bb
