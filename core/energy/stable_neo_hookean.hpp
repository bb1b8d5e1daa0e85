// Stable neo-Hookean membrane density (Smith, de Goes, Kim 2018), in two dimensions.
#pragma once

#include "core/energy/isotropic.hpp"

namespace bb {

/// psi = mu/2 (|F|^2 - 2) - mu (J-1) + lambda/2 (J-1)^2, J = s0 s1; evaluated as mu/2 (s0-s1)^2 +
/// lambda/2 (J-1)^2, the same function without cancellation near rest. A polynomial in a 2x2 F.
/// Host-device: yes. Total.
struct StableNeoHookean {
  template <class T>
  BB_HD static Density2<T> eval(const Vec<T, 2>& s, T lame_mu, T lame_lambda) {
    const T difference = s[0] - s[1];
    const T volume = s[0] * s[1] - T(1);
    Density2<T> out;
    out.psi = lame_mu / T(2) * difference * difference + lame_lambda / T(2) * volume * volume;
    out.dpsi = Vec<T, 2>(lame_mu * difference + lame_lambda * volume * s[1],
                         lame_lambda * volume * s[0] - lame_mu * difference);
    out.d2psi(0, 0) = lame_mu + lame_lambda * s[1] * s[1];
    out.d2psi(1, 1) = lame_mu + lame_lambda * s[0] * s[0];
    out.d2psi(0, 1) = out.d2psi(1, 0) = lame_lambda * (T(2) * volume + T(1)) - lame_mu;
    out.flip = T(2) * lame_mu - lame_lambda * volume;
    out.twist = lame_lambda * volume;
    return out;
  }
};

namespace membrane {
using stable_neo_hookean = Isotropic<StableNeoHookean>;
}

}  // namespace bb
