// A spring that resists tension and compression differently, each with a linear part and one that grows exponentially.
#pragma once

#include "core/energy/creep.hpp"
#include "core/energy/stiffening.hpp"
#include "core/energy/terms.hpp"

namespace bb {

/// Stiffness of a spring longer (tension) and shorter (compression) than at rest, N/m; the growing parts are those at rest length
/// and grow e-fold with every 1/exponent of relative elongation. With a softening the length of a spring is
/// sqrt(|d|^2 + softening^2), which is smooth at d = 0.
template <class T>
struct SpringLaw {
  T tension, tension_growing, compression, compression_growing;
  T exponent;       // 1, > 0
  T softening = 0;  // m
};

/// Length of a spring, m. Without a softening it is |x1 - x0|, to the bit. Host-device: yes.
template <class T>
BB_HD T spring_length(const Vec<T, 3> (&x)[2], T softening) {
  using std::sqrt;
  return sqrt((x[1] - x[0]).squaredNorm() + softening * softening);
}

/// w(u) of u = l - l0 (stiffening.hpp), by its sign. Requires l0 > 0. Host-device: yes.
template <class T>
BB_HD Stiffened<T> spring_profile(T elongation, T rest_length, const SpringLaw<T>& law) {
  const bool shorter = elongation < T(0);
  return stiffened<T>(elongation, shorter ? law.compression : law.tension,
                      shorter ? law.compression_growing : law.tension_growing, law.exponent / rest_length);
}

/// How many times its given length (m, already shrunk) a spring rests at after it has crept at x; `ratio` is what it was. Host-device: yes.
/// @param length, rest_length  m, before     @param yield, kept  as those of crept()
template <class T>
BB_HD T crept_ratio(T length, T rest_length, T given, T yield, T kept, T ratio) {
  const T elongation = length / rest_length - 1;
  const T left = crept(elongation, yield, kept), next = length / (1 + left) / given;
  const bool is_number = next - next == T(0);
  return left != elongation && is_number && next > T(0) ? next : ratio;
}

/// Energy, J. Host-device: yes.
template <class T>
BB_HD T cloth_spring_value(const Vec<T, 3> (&x)[2], T rest_length, const SpringLaw<T>& law) {
  return spring_profile<T>(spring_length<T>(x, law.softening) - rest_length, rest_length, law).energy;
}

/// Whether the energy has a cusp at x: the points coincide, and it falls whichever way they part. Host-device: yes.
template <class T>
BB_HD bool cloth_spring_is_cusp(const Vec<T, 3> (&x)[2], T rest_length, const SpringLaw<T>& law) {
  return !(spring_length<T>(x, law.softening) > T(0)) &&
         spring_profile<T>(-rest_length, rest_length, law).slope < T(0);
}

/// Energy, gradient and Hessian w'' u u^T + w'/l (1 - u u^T), u = d/l; l is the softened length, so that |u| <= 1. Eigenvalues are
/// w'/l across d, negative in compression, and w'' |u|^2 + w'/l (1 - |u|^2) along it. At rest length the curvature is that of tension;
/// at l = 0, a cusp, gradient and Hessian are 0. Host-device: yes. Total.
template <class T>
BB_HD ElementTerms<T, 6> cloth_spring_terms(const Vec<T, 3> (&x)[2], T rest_length, const SpringLaw<T>& law,
                                            Projection projection) {
  const Vec<T, 3> difference = x[1] - x[0];
  const T length = spring_length<T>(x, law.softening), distance = difference.norm();
  const Stiffened<T> w = spring_profile<T>(length - rest_length, rest_length, law);
  const bool there = length > T(0);
  const Vec<T, 3> n = distance > T(0) ? Vec<T, 3>(difference / distance) : Vec<T, 3>(Vec<T, 3>::Zero());
  const Vec<T, 3> force =
      law.softening > T(0) ? Vec<T, 3>(w.slope * (difference / length)) : Vec<T, 3>(w.slope * n);
  const T across = there ? w.slope / length : T(0), share = distance / length * (distance / length);
  const T along = law.softening > T(0)
                      ? project_eigenvalue(w.curvature * share + across * (T(1) - share), projection)
                      : w.curvature;
  const T transverse = there ? project_eigenvalue(across, projection) : T(0);
  Mat<T, 3, 3> block = transverse * Mat<T, 3, 3>::Identity() + (along - transverse) * (n * n.transpose());
  mirror_lower<T, 3>(block);

  ElementTerms<T, 6> out;
  out.energy = w.energy;
  out.grad << -force, force;
  out.hess << block, -block, -block, block;
  return out;
}

// Compiled once for these scalars, in element_terms.cpp: kernels that call it are in headers of many files.
#ifndef __CUDACC__
extern template ElementTerms<float, 6> cloth_spring_terms<float>(const Vec<float, 3> (&)[2], float,
                                                                 const SpringLaw<float>&, Projection);
extern template ElementTerms<double, 6> cloth_spring_terms<double>(const Vec<double, 3> (&)[2], double,
                                                                   const SpringLaw<double>&, Projection);
#endif

}  // namespace bb
