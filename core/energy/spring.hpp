// A spring between two points.
#pragma once

#include "core/energy/terms.hpp"

namespace bb {

/// Energy (J) k/2 (l - l0)^2, l = |x1 - x0|; k in N/m, l0 in m. Host-device: yes. Total.
template <class T>
BB_HD T spring_value(const Vec<T, 3> (&x)[2], T stiffness, T rest_length) {
  const T stretch = (x[1] - x[0]).norm() - rest_length;
  return stiffness / T(2) * stretch * stretch;
}

/// Whether the energy has a cusp at x: the points coincide, and it falls whichever way they part. Host-device: yes.
template <class T>
BB_HD bool spring_is_cusp(const Vec<T, 3> (&x)[2], T stiffness, T rest_length) {
  return stiffness > T(0) && rest_length > T(0) && !((x[1] - x[0]).norm() > T(0));
}

/// C = l - l0 (m), whose energy C^2/(2 compliance) with compliance 1/k is that of the spring; gradient -n, n, 0 at l = 0.
/// Host-device: yes. Total.
template <class T>
BB_HD T spring_stretch(const Vec<T, 3> (&x)[2], T rest_length, Vec<T, 3> (&gradient)[2]) {
  const Vec<T, 3> difference = x[1] - x[0];
  const T length = difference.norm();
  gradient[1] = length > T(0) ? Vec<T, 3>(difference / length) : Vec<T, 3>(Vec<T, 3>::Zero());
  gradient[0] = -gradient[1];
  return length - rest_length;
}

/// Energy, gradient and Hessian k (n n^T + (1 - l0/l)(1 - n n^T)), n the unit direction; the transverse part
/// is negative in compression. At l = 0 (a cusp unless l0 = 0) gradient and Hessian are those with n = 0.
/// Host-device: yes. Total.
template <class T>
BB_HD ElementTerms<T, 6> spring_terms(const Vec<T, 3> (&x)[2], T stiffness, T rest_length,
                                      Projection projection) {
  const Vec<T, 3> difference = x[1] - x[0];
  const T length = difference.norm();
  const Vec<T, 3> n = length > T(0) ? Vec<T, 3>(difference / length) : Vec<T, 3>(Vec<T, 3>::Zero());
  const T ratio = length > T(0) ? rest_length / length : (rest_length > T(0) ? T(1) : T(0));
  const T transverse = project_eigenvalue(T(1) - ratio, projection);
  const Vec<T, 3> force = stiffness * (length - rest_length) * n;
  Mat<T, 3, 3> block =
      stiffness * (transverse * Mat<T, 3, 3>::Identity() + (T(1) - transverse) * (n * n.transpose()));
  mirror_lower<T, 3>(block);

  ElementTerms<T, 6> out;
  out.energy = spring_value<T>(x, stiffness, rest_length);
  out.grad << -force, force;
  out.hess << block, -block, -block, block;
  return out;
}

// Compiled once for these scalars, in element_terms.cpp: kernels that call it are in headers of many files.
#ifndef __CUDACC__
extern template ElementTerms<float, 6> spring_terms<float>(const Vec<float, 3> (&)[2], float, float,
                                                           Projection);
extern template ElementTerms<double, 6> spring_terms<double>(const Vec<double, 3> (&)[2], double, double,
                                                             Projection);
#endif

}  // namespace bb
