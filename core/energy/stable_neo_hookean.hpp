// Stable neo-Hookean density (Smith, de Goes, Kim 2018) of triangles and tetrahedra.
#pragma once

#include "core/energy/isotropic.hpp"

namespace bb {

/// psi = mu/2 (|F|^2 - N) - mu (J-1) + lambda/2 (J-1)^2, J the product of all s: that of two values is that of three whose last is
/// 1. Written without cancellation near rest: with p = s0 s1 - 1 and c = s2 - 1,
///   mu/2 (s0-s1)^2 + mu/2 c (c - 2p) + lambda/2 (J-1)^2,   J - 1 = p s2 + c.
/// Two values: smallest at rest where lambda > 0; three: where lambda > mu/3 (a Poisson's ratio above 1/8); unbounded below where lambda <= 0.
/// Its moduli at rest are mu and lambda - mu. A polynomial in a square F. Host-device: yes. Total.
struct StableNeoHookean {
  template <class T, int N>
  BB_HD static Density<T, N> eval(const Vec<T, N>& s, T lame_mu, T lame_lambda) {
    const T last = N == 3 ? s[N - 1] : T(1);
    const T difference = s[0] - s[1], c = last - T(1);
    const T p = s[0] * s[1] - T(1);
    const T volume = p * last + c;
    const T a0 = s[1] * last, a1 = s[0] * last, slope = lame_lambda * (T(2) * volume + T(1)) - lame_mu;
    Density<T, N> out;
    out.psi = lame_mu / T(2) * difference * difference + lame_mu / T(2) * c * (c - T(2) * p) +
              lame_lambda / T(2) * volume * volume;
    out.dpsi[0] = lame_mu * (difference - c * s[1]) + lame_lambda * volume * a0;
    out.dpsi[1] = lame_lambda * volume * a1 - lame_mu * (difference + c * s[0]);
    out.d2psi(0, 0) = lame_mu + lame_lambda * a0 * a0;
    out.d2psi(1, 1) = lame_mu + lame_lambda * a1 * a1;
    if constexpr (N == 3) {
      const T a2 = s[0] * s[1];
      out.dpsi[2] = lame_mu * (c - p) + lame_lambda * volume * a2;
      out.d2psi(2, 2) = lame_mu + lame_lambda * a2 * a2;
    }
    for (int i = 0; i < N; ++i) {
      for (int j = i + 1; j < N; ++j) {
        const T third = N == 3 ? s[3 - i - j] : T(1);
        out.d2psi(i, j) = out.d2psi(j, i) = third * slope;
        out.flip[sigma_pair(i, j)] = lame_mu * (T(1) + third) - lame_lambda * volume * third;
        out.twist[sigma_pair(i, j)] = lame_lambda * volume * third - lame_mu * (third - T(1));
      }
    }
    return out;
  }
};

namespace membrane {
using stable_neo_hookean = Isotropic<StableNeoHookean>;
}
namespace solid {
using stable_neo_hookean = Isotropic<StableNeoHookean>;
}

}  // namespace bb
