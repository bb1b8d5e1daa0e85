// Corotational (corotated linear) membrane density.
#pragma once

#include "core/energy/isotropic.hpp"

namespace bb {

/// psi = mu sum (s-1)^2 + lambda/2 (sum (s-1))^2.
/// Host-device: yes. Total. Cusp at s0 + s1 = 0 (rotation undefined).
struct Corotational {
  template <class T>
  BB_HD static Density2<T> eval(const Vec<T, 2>& s, T lame_mu, T lame_lambda) {
    const Vec<T, 2> e(s[0] - T(1), s[1] - T(1));
    const T trace = e[0] + e[1];
    const T sum = s[0] + s[1];
    Density2<T> out;
    out.psi = lame_mu * e.squaredNorm() + lame_lambda / T(2) * trace * trace;
    out.dpsi =
        Vec<T, 2>(T(2) * lame_mu * e[0] + lame_lambda * trace, T(2) * lame_mu * e[1] + lame_lambda * trace);
    out.d2psi(0, 0) = out.d2psi(1, 1) = T(2) * lame_mu + lame_lambda;
    out.d2psi(0, 1) = out.d2psi(1, 0) = lame_lambda;
    out.flip = T(2) * lame_mu;
    out.twist = sum > T(0) ? T(2) * (lame_mu + lame_lambda) * trace / sum : T(0);
    return out;
  }
};

namespace membrane {
using corotational = Isotropic<Corotational>;
}

}  // namespace bb
