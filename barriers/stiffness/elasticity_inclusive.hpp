// The formula of the stiffness policy `elasticity_inclusive`, for one contact. Element math; the policy and
// `eval` call the same function.
#pragma once

#include "core/barrier/stiffness_policy.hpp"
#include "core/math/host_device.hpp"

namespace bb {

/// Which terms enter, and the time step for MassTerm::inertia. c = 0 (no inertia) makes that term 0.
struct ElasticityInclusiveRule {
  MassTerm mass_term = MassTerm::paper;
  bool elastic_term = true;
  double dt = 0;  // s
  double c = 1;   // inertia weight M/(c dt^2)
};

/// kappa = w^T (M' + H) w/(w^T w), w the stacked w_i n over the free vertices (N/m).
///   M' = M/d^2 times 1 m^2/s^2 (paper: the unit constant is the paper's), M/(c dt^2) (inertia) or 0 (none)
///   H the 3N x 3N sub-matrix of the PSD elastic Hessian, off-diagonal blocks included
/// @param n_free   N, 1..4            @param weight  [N] w_i, not all 0
/// @param normal   [3] not 0          @param d       gap, m; > 0 for MassTerm::paper
/// @param mass     [N] kg; read unless MassTerm::none
/// @param hessian  column-major, leading dimension ld >= 3N, N/m; read when elastic_term
/// Errors: none. Host-device. Cost: O(N^2), allocates nothing.
/// Source: Ando 2024, section on elasticity-inclusive stiffness; differs by: off-diagonal blocks of H kept as
/// in the published code, w over free vertices only.
template <class T>
BB_HD T elasticity_inclusive_kappa(int n_free, const T* weight, const T* normal, T d, const T* mass,
                                   const T* hessian, int ld, const ElasticityInclusiveRule& rule) {
  T w_sq = T(0), mass_sum = T(0), elastic = T(0);
  const T n_sq = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
  for (int i = 0; i < n_free; ++i) {
    const T wi_sq = weight[i] * weight[i];
    w_sq += wi_sq * n_sq;
    if (rule.mass_term != MassTerm::none) mass_sum += wi_sq * n_sq * mass[i];
  }
  if (rule.elastic_term) {
    for (int j = 0; j < 3 * n_free; ++j) {
      const T wj = weight[j / 3] * normal[j % 3];
      T column = T(0);
      for (int i = 0; i < 3 * n_free; ++i) column += weight[i / 3] * normal[i % 3] * hessian[j * ld + i];
      elastic += column * wj;
    }
  }
  T inertia = T(0);
  if (rule.mass_term == MassTerm::paper) inertia = mass_sum / (d * d);
  if (rule.mass_term == MassTerm::inertia && rule.c > 0) inertia = mass_sum / T(rule.c * rule.dt * rule.dt);
  return (inertia + elastic) / w_sq;
}

}  // namespace bb
