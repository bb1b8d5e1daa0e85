// The formula of the stiffness policy `elasticity_inclusive`, for one contact. Element math; the policy and
// `eval` call the same function.
#pragma once

#include "core/barrier/stiffness_policy.hpp"
#include "core/math/host_device.hpp"

namespace bb {

/// Which terms enter, and the time step for MassTerm::inertia and scaled. c = 0 (no inertia) makes them 0.
struct ElasticityInclusiveRule {
  MassTerm mass_term = MassTerm::paper;
  bool elastic_term = true;
  double dt = 0;  // s
  double c = 1;   // inertia weight M/(c dt^2)
};

/// w^T M w, w^T H w and w^T w of one contact, w the stacked w_i n over its free vertices.
template <class T>
struct ElasticityInclusiveSums {
  T mass = T(0), elastic = T(0), w_sq = T(0);  // kg, N/m, 1

  /// w^T M w/(c dt^2), N/m.
  BB_HD T inertia(const ElasticityInclusiveRule& rule) const {
    return rule.c > 0 ? mass / T(rule.c * rule.dt * rule.dt) : T(0);
  }
};

/// A matrix in memory, column-major with a leading dimension, as a function of row and column.
template <class T>
struct ColumnMajor {
  const T* values;
  int ld;
  BB_HD T operator()(int row, int column) const { return values[column * ld + row]; }
};

/// @param n_free   N, 1..4            @param weight  [N] w_i, not all 0
/// @param normal   [3] not 0          @param mass    [N] kg; read unless MassTerm::none
/// @param hessian  hessian(row, column) with both below 3N, N/m; read when elastic_term
/// Errors: none. Host-device. Cost: O(N^2), allocates nothing.
template <class T, class Hessian>
BB_HD ElasticityInclusiveSums<T> elasticity_inclusive_sums(int n_free, const T* weight, const T* normal,
                                                           const T* mass, const Hessian& hessian,
                                                           const ElasticityInclusiveRule& rule) {
  ElasticityInclusiveSums<T> sums;
  const T n_sq = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
  for (int i = 0; i < n_free; ++i) {
    const T wi_sq = weight[i] * weight[i];
    sums.w_sq += wi_sq * n_sq;
    if (rule.mass_term != MassTerm::none) sums.mass += wi_sq * n_sq * mass[i];
  }
  if (!rule.elastic_term) return sums;
  for (int j = 0; j < 3 * n_free; ++j) {
    const T wj = weight[j / 3] * normal[j % 3];
    T column = T(0);
    for (int i = 0; i < 3 * n_free; ++i) column += weight[i / 3] * normal[i % 3] * hessian(i, j);
    sums.elastic += column * wj;
  }
  return sums;
}

/// kappa = w^T (M' + H) w/(w^T w), N/m.
///   M' = M/d^2 times 1 m^2/s^2 (paper: the unit constant is the paper's), M/(c dt^2) (inertia),
///   M/(c dt^2) (d_hat/d)^2 (scaled) or 0 (none)
///   H the 3N x 3N sub-matrix of the PSD elastic Hessian, off-diagonal blocks included
/// @param d  gap, m; > 0 for MassTerm::paper and scaled   @param d_hat  m, read by scaled; others as above
/// Errors: none. Host-device.
/// Source: Ando 2024, section on elasticity-inclusive stiffness; differs by: off-diagonal blocks of H kept as
/// in the published code, w over free vertices only, the mass terms inertia and scaled.
template <class T, class Hessian>
BB_HD T elasticity_inclusive_kappa(int n_free, const T* weight, const T* normal, T d, T d_hat, const T* mass,
                                   const Hessian& hessian, const ElasticityInclusiveRule& rule) {
  const auto sums = elasticity_inclusive_sums(n_free, weight, normal, mass, hessian, rule);
  T mass_part = T(0);
  if (rule.mass_term == MassTerm::paper) mass_part = sums.mass / (d * d);
  if (rule.mass_term == MassTerm::inertia) mass_part = sums.inertia(rule);
  if (rule.mass_term == MassTerm::scaled) mass_part = sums.inertia(rule) * (d_hat * d_hat / (d * d));
  return (mass_part + sums.elastic) / sums.w_sq;
}

/// The same as a function of the gap: at(d) is that kappa up to rounding.
template <class T, class Hessian>
BB_HD KappaPartsOf<T> elasticity_inclusive_parts(int n_free, const T* weight, const T* normal, T d_hat,
                                                 const T* mass, const Hessian& hessian,
                                                 const ElasticityInclusiveRule& rule) {
  const auto sums = elasticity_inclusive_sums(n_free, weight, normal, mass, hessian, rule);
  KappaPartsOf<T> parts{sums.elastic / sums.w_sq, T(0)};
  if (rule.mass_term == MassTerm::paper) parts.per_gap_sq = sums.mass / sums.w_sq;
  if (rule.mass_term == MassTerm::inertia) parts.fixed += sums.inertia(rule) / sums.w_sq;
  if (rule.mass_term == MassTerm::scaled) parts.per_gap_sq = sums.inertia(rule) * d_hat * d_hat / sums.w_sq;
  return parts;
}

// The same with the sub-matrix in memory: column-major, leading dimension ld >= 3N.
template <class T>
BB_HD T elasticity_inclusive_kappa(int n_free, const T* weight, const T* normal, T d, T d_hat, const T* mass,
                                   const T* hessian, int ld, const ElasticityInclusiveRule& rule) {
  return elasticity_inclusive_kappa(n_free, weight, normal, d, d_hat, mass, ColumnMajor<T>{hessian, ld},
                                    rule);
}
template <class T>
BB_HD KappaPartsOf<T> elasticity_inclusive_parts(int n_free, const T* weight, const T* normal, T d_hat,
                                                 const T* mass, const T* hessian, int ld,
                                                 const ElasticityInclusiveRule& rule) {
  return elasticity_inclusive_parts(n_free, weight, normal, d_hat, mass, ColumnMajor<T>{hessian, ld}, rule);
}

}  // namespace bb
