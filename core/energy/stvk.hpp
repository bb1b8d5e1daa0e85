// Saint Venant-Kirchhoff density of triangles and tetrahedra.
#pragma once

#include "core/energy/isotropic.hpp"

namespace bb {

/// psi = mu |E|^2 + lambda/2 tr(E)^2, E = (F^T F - 1)/2. A polynomial in F: smooth everywhere.
/// Host-device: yes. Total.
struct Stvk {
  template <class T, int N>
  BB_HD static Density<T, N> eval(const Vec<T, N>& s, T lame_mu, T lame_lambda) {
    Vec<T, N> e;
    for (int k = 0; k < N; ++k) e[k] = (s[k] - T(1)) * (s[k] + T(1)) / T(2);
    T trace = e[0];
    for (int k = 1; k < N; ++k) trace += e[k];
    const T stiffness = T(2) * lame_mu + lame_lambda;
    Density<T, N> out;
    out.psi = lame_mu * e.squaredNorm() + lame_lambda / T(2) * trace * trace;
    for (int k = 0; k < N; ++k) {
      const T pressure = T(2) * lame_mu * e[k] + lame_lambda * trace;
      out.dpsi[k] = s[k] * pressure;
      out.d2psi(k, k) = pressure + stiffness * s[k] * s[k];
    }
    for (int i = 0; i < N; ++i) {
      for (int j = i + 1; j < N; ++j) {
        const T product = s[i] * s[j];
        out.d2psi(i, j) = out.d2psi(j, i) = lame_lambda * product;
        // s_i^2 -+ s_i s_j + s_j^2 - 1 = 2 (e_i + e_j) + 1 -+ s_i s_j
        const T strain = T(2) * (e[i] + e[j]);
        out.flip[sigma_pair(i, j)] = lame_mu * (strain + (T(1) + product)) + lame_lambda * trace;
        out.twist[sigma_pair(i, j)] = lame_mu * (strain + (T(1) - product)) + lame_lambda * trace;
      }
    }
    return out;
  }
};

namespace membrane {
using stvk = Isotropic<Stvk>;
}
namespace solid {
using stvk = Isotropic<Stvk>;
}

}  // namespace bb
