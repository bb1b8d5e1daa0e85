// What every element energy returns.
#pragma once

#include "core/math/lower_blocks.hpp"
#include "core/math/projection.hpp"
#include "core/math/types.hpp"

namespace bb {

/// Makes `m` symmetric bit for bit: its lower triangle is copied to the upper one.
template <class T, int N>
BB_HD void mirror_lower(Mat<T, N, N>& m) {
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < i; ++j) m(j, i) = m(i, j);
  }
}

/// Terms of one element; N = 3 x number of points, point-major. Which eigenvalues a projected Hessian has:
/// membranes and strain limits project d2psi/dF2, before the constant chain rule to the vertices; springs and
/// hinges the whole matrix.
template <class T, int N>
struct ElementTerms {
  T energy;           // J
  Vec<T, N> grad;     // N
  Mat<T, N, N> hess;  // N/m, symmetric bit for bit
};

/// Terms of L elements of W points, number by number: what a function on lanes hands over. Host only.
template <class T, int L, int W>
struct TermsAbreast {
  T energy[L];
  T grad[3 * W][L];
  T hess[n_lower_numbers(W)][L];  // lower blocks
};

}  // namespace bb
