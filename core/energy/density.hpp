// What an isotropic membrane density supplies: its derivatives in the two singular values of F.
#pragma once

#include "core/math/types.hpp"

namespace bb {

/// psi(s0, s1), symmetric in its arguments; s1 carries the sign of det F when F is 2x2. Units of the Lame
/// parameters (N/m for shells). `flip` and `twist` are written in closed form, so that they keep all digits
/// where their quotients are 0/0.
template <class T>
struct Density2 {
  T psi;
  Vec<T, 2> dpsi;
  Mat<T, 2, 2> d2psi;
  T flip;   // (dpsi_0 - dpsi_1)/(s0 - s1)
  T twist;  // (dpsi_0 + dpsi_1)/(s0 + s1); 0 at s0 + s1 = 0 where the density has a cusp
};

}  // namespace bb
