// What an isotropic density supplies: its derivatives in the singular values of F.
#pragma once

#include "core/math/types.hpp"

namespace bb {

/// Number of the pair (i, j), i < j, of singular values: (0, 1), (0, 2), (1, 2).
BB_HD constexpr int sigma_pair(int i, int j) { return i + j - 1; }

/// psi of N singular values, symmetric in its arguments; the last carries the sign of det F when F is square. Units of the Lame
/// parameters (N/m for shells, Pa for solids). `flip` and `twist`, one a pair of values, are written in closed form, so that they
/// keep all digits where their quotients are 0/0.
template <class T, int N>
struct Density {
  T psi;
  Vec<T, N> dpsi;
  Mat<T, N, N> d2psi;
  Vec<T, N*(N - 1) / 2> flip;  // (dpsi_i - dpsi_j)/(s_i - s_j)
  Vec<T, N*(N - 1) / 2>
      twist;  // (dpsi_i + dpsi_j)/(s_i + s_j); 0 at s_i + s_j = 0 where the density has a cusp
};

/// Of triangles.
template <class T>
using Density2 = Density<T, 2>;

}  // namespace bb
