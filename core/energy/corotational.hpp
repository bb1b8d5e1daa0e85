// Corotational (corotated linear) density of triangles and tetrahedra.
#pragma once

#include "core/energy/isotropic.hpp"

namespace bb {

/// psi = mu sum (s-1)^2 + lambda/2 (sum (s-1))^2.
/// Host-device: yes. Lanes: of triangles. Total. Cusp where two values add up to 0 (rotation undefined).
struct Corotational {
  template <class T, int N>
  BB_HD static Density<T, N> eval(const Vec<T, N>& s, T lame_mu, T lame_lambda) {
    const Vec<T, N> e = s - Vec<T, N>::Constant(T(1));
    T trace = e[0];
    for (int k = 1; k < N; ++k) trace += e[k];
    Density<T, N> out;
    out.psi = lame_mu * e.squaredNorm() + lame_lambda / T(2) * trace * trace;
    for (int k = 0; k < N; ++k) {
      out.dpsi[k] = T(2) * lame_mu * e[k] + lame_lambda * trace;
      for (int l = 0; l < N; ++l) out.d2psi(k, l) = k == l ? T(2) * lame_mu + lame_lambda : lame_lambda;
    }
    for (int i = 0; i < N; ++i) {
      for (int j = i + 1; j < N; ++j) {
        const T sum = s[i] + s[j];
        const T others = N == 3 ? e[3 - i - j] : T(0);
        const T force = T(2) * (lame_mu + lame_lambda) * (e[i] + e[j]) + T(2) * lame_lambda * others;
        out.flip[sigma_pair(i, j)] = T(2) * lame_mu;
        out.twist[sigma_pair(i, j)] = select(sum > T(0), force / sum, T(0));
      }
    }
    return out;
  }
};

namespace membrane {
using corotational = Isotropic<Corotational>;
}
namespace solid {
using corotational = Isotropic<Corotational>;
}

}  // namespace bb
