// Stiffness policies of strain limiting: kappa_e (J) of one element.
#pragma once

#include "core/barrier/stiffness_policy.hpp"
#include "core/energy/terms.hpp"

namespace bb {

/// Which terms enter the elasticity-inclusive kappa_e, and the time step for MassTerm::inertia and scaled. c = 0
/// (quasi-static) makes those terms 0.
struct StrainStiffnessRule {
  MassTerm mass_term = MassTerm::paper;
  bool elastic_term = true;
  double dt = 0;  // s
  double c = 1;   // inertia weight M/(c dt^2)
};

/// kappa_e(y) = w^T H w + mass part, w_i = x_i - centroid; not divided by w^T w.
///   paper    m_e/y^2 times 1 m^2/s^2 (the unit constant is the paper's)
///   inertia  w^T M w/(c dt^2)
///   scaled   w^T M w/(c dt^2) (width/y)^2
///   none     0
/// Asked at the smaller pseudo-gap y of the element, > 0 where the mass part depends on it.
/// @param x             points at the start of the step, m
/// @param hess          9 x 9 sub-matrix of the assembled PSD elastic Hessian, N/m
/// @param vertex_mass   kg, read by inertia and scaled     @param element_mass kg, read by paper
/// @param width         of the limit, read by scaled
/// Host-device: yes. Total. Source: Ando 2024; ppf-contact-solver, strain limiting.
template <class T>
BB_HD KappaPartsOf<T> strain_stiffness(const Vec<T, 3> (&x)[3], const Mat<T, 9, 9>& hess,
                                       const Vec<T, 3>& vertex_mass, T element_mass, T width,
                                       const StrainStiffnessRule& rule) {
  const Vec<T, 3> centroid = (x[0] + x[1] + x[2]) / T(3);
  Vec<T, 9> w;
  T inertia = T(0);
  for (int i = 0; i < 3; ++i) {
    w.template segment<3>(3 * i) = x[i] - centroid;
    inertia += vertex_mass[i] * (x[i] - centroid).squaredNorm();
  }
  KappaPartsOf<T> kappa;
  if (rule.elastic_term) kappa.fixed = w.dot(hess.lazyProduct(w));  // in the order of a device
  if (rule.mass_term == MassTerm::paper) kappa.per_gap_sq = element_mass;
  if (!(rule.c > 0)) return kappa;
  inertia /= T(rule.c * rule.dt * rule.dt);
  if (rule.mass_term == MassTerm::inertia) kappa.fixed += inertia;
  if (rule.mass_term == MassTerm::scaled) kappa.per_gap_sq = inertia * (width * width);
  return kappa;
}

}  // namespace bb
