// Saint Venant-Kirchhoff membrane density.
#pragma once

#include "core/energy/isotropic.hpp"

namespace bb {

/// psi = mu |E|^2 + lambda/2 tr(E)^2, E = (F^T F - 1)/2. A polynomial in F: smooth everywhere.
/// Host-device: yes. Total.
struct Stvk {
  template <class T>
  BB_HD static Density2<T> eval(const Vec<T, 2>& s, T lame_mu, T lame_lambda) {
    const Vec<T, 2> e((s[0] - T(1)) * (s[0] + T(1)) / T(2), (s[1] - T(1)) * (s[1] + T(1)) / T(2));
    const T trace = e[0] + e[1];
    const T product = s[0] * s[1];
    const T stiffness = T(2) * lame_mu + lame_lambda;
    Density2<T> out;
    out.psi = lame_mu * e.squaredNorm() + lame_lambda / T(2) * trace * trace;
    for (int k = 0; k < 2; ++k) {
      const T pressure = T(2) * lame_mu * e[k] + lame_lambda * trace;
      out.dpsi[k] = s[k] * pressure;
      out.d2psi(k, k) = pressure + stiffness * s[k] * s[k];
    }
    out.d2psi(0, 1) = out.d2psi(1, 0) = lame_lambda * product;
    // s0^2 -+ s0 s1 + s1^2 - 1 = 2 tr(E) + 1 -+ s0 s1
    out.flip = lame_mu * (T(2) * trace + (T(1) + product)) + lame_lambda * trace;
    out.twist = lame_mu * (T(2) * trace + (T(1) - product)) + lame_lambda * trace;
    return out;
  }
};

namespace membrane {
using stvk = Isotropic<Stvk>;
}

}  // namespace bb
