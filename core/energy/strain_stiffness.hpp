// The sums from which a policy makes kappa_e (J) of one strain-limited triangle.
#pragma once

#include "core/barrier/stiffness_sums.hpp"
#include "core/energy/terms.hpp"

namespace bb {

/// w^T M w and w^T H w with w_i = x_i - centroid.
/// @param x            points at the start of the step, m
/// @param hessian      hessian() is the 9 x 9 sub-matrix of the assembled PSD elastic Hessian, N/m; asked when with_hessian
/// @param vertex_mass  kg    @param element_mass kg    @param area m^2, at rest
/// Host-device: yes. Total. Source: Ando 2024; ppf-contact-solver, strain limiting.
template <class T, class Hessian>
BB_HD ElementSums<T> element_sums(const Vec<T, 3> (&x)[3], const Vec<T, 3>& vertex_mass, T element_mass,
                                  T area, const Hessian& hessian, bool with_hessian) {
  const Vec<T, 3> centroid = (x[0] + x[1] + x[2]) / T(3);
  Vec<T, 9> w;
  ElementSums<T> sums;
  for (int i = 0; i < 3; ++i) {
    w.template segment<3>(3 * i) = x[i] - centroid;
    sums.mass += vertex_mass[i] * (x[i] - centroid).squaredNorm();
  }
  if (with_hessian) sums.elastic = w.dot(hessian().lazyProduct(w));  // in the order of a device
  sums.element_mass = element_mass;
  sums.area = area;
  return sums;
}

}  // namespace bb
