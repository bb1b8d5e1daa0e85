// The sums from which a policy makes kappa_e (J) of one strain-limited element.
#pragma once

#include "core/barrier/stiffness_sums.hpp"
#include "core/energy/terms.hpp"

namespace bb {

/// w^T M w and w^T H w with w_i = x_i - centroid.
/// @param x            points of a triangle or tetrahedron at the start of the step, m
/// @param hessian      hessian() is the 3 P x 3 P sub-matrix of the assembled PSD elastic Hessian, N/m; read when with_hessian
/// @param vertex_mass  kg    @param element_mass kg    @param measure m^2 or m^3, at rest
/// Host-device: yes. Total. Source: Ando 2024; ppf-contact-solver, strain limiting.
template <class T, int P, class Hessian>
BB_HD ElementSums<T> element_sums(const Vec<T, 3> (&x)[P], const Vec<T, P>& vertex_mass, T element_mass,
                                  T measure, const Hessian& hessian, bool with_hessian) {
  Vec<T, 3> centroid = x[0];
  for (int i = 1; i < P; ++i) centroid += x[i];
  centroid /= T(P);
  Vec<T, 3 * P> w;
  ElementSums<T> sums;
  for (int i = 0; i < P; ++i) {
    w.template segment<3>(3 * i) = x[i] - centroid;
    sums.mass += vertex_mass[i] * (x[i] - centroid).squaredNorm();
  }
  if (with_hessian) sums.elastic = w.dot(hessian().lazyProduct(w));  // in the order of a device
  sums.element_mass = element_mass;
  sums.measure = measure;
  return sums;
}

}  // namespace bb
