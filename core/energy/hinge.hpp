// Dihedral bending of two triangles (e0 e1 v0), (e1 e0 v1) that share the edge e0 e1: quadratic in the angle.
#pragma once

#include <cmath>
#include <limits>

#include "core/energy/creep.hpp"
#include "core/energy/stiffening.hpp"
#include "core/energy/terms.hpp"
#include "core/math/atan2.hpp"
#include "core/math/psd.hpp"

namespace bb {

/// Angle in (-pi, pi] between the normals e x a and b x e (e = e1 - e0, a = v0 - e0, b = v1 - e0), 0 when
/// flat, positive when the normals turn about +e from the first triangle to the second; by atan2, so that it
/// keeps its digits near 0 and pi. Points in the order e0 e1 v0 v1. Host-device: yes. Total.
template <class T>
BB_HD T hinge_angle(const Vec<T, 3> (&x)[4]) {
  using elementary::atan2;
  const Vec<T, 3> e = x[1] - x[0], b = x[3] - x[0];
  const Vec<T, 3> n0 = e.cross(Vec<T, 3>(x[2] - x[0])), n1 = b.cross(e);
  return atan2(-e.norm() * n0.dot(b), n0.dot(n1));
}

/// theta - rest_angle brought to (-pi, pi]. Unchanged when already there.
template <class T>
BB_HD T hinge_deviation(T angle, T rest_angle) {
  using std::abs, std::remainder;
  const T pi = T(3.14159265358979323846), difference = angle - rest_angle;
  if (abs(difference) < pi)
    return difference;  // which remainder() gives back bit for bit, after a long division
  const T deviation = remainder(difference, T(2) * pi);
  return deviation > -pi ? deviation : deviation + T(2) * pi;
}

/// Gradient and Hessian of the angle in the reduced variables (e, a, b), nine numbers.
template <class T>
struct HingeAngleTerms {
  Vec<T, 9> grad;     // 1/m
  Mat<T, 9, 9> hess;  // 1/m^2
};

template <class T>
BB_HD Mat<T, 3, 3> cross_matrix(const Vec<T, 3>& v) {
  Mat<T, 3, 3> out;
  out << T(0), -v[2], v[1], v[2], T(0), -v[0], -v[1], v[0], T(0);
  return out;
}

/// One side of the hinge, added with its sign: how far the vertex at `a` (slot 1 or 2) has turned about
/// e. Its gradient is c in a and -t c in e, with c = |e| n/|n|^2, n = e x a, t = a.e/|e|^2; the Hessian
/// is their derivative.
template <class T>
BB_HD void add_hinge_side(const Vec<T, 3>& e, const Vec<T, 3>& a, T sign, int slot, HingeAngleTerms<T>& out) {
  const T e_sq = e.squaredNorm(), length = e.norm();
  const Vec<T, 3> n = e.cross(a);
  const T n_sq = n.squaredNorm();
  const Vec<T, 3> c = length / n_sq * n;
  const T t = a.dot(e) / e_sq;
  const Mat<T, 3, 3> dc_dn = length / n_sq * (Mat<T, 3, 3>::Identity() - (T(2) / n_sq) * n * n.transpose());
  const Mat<T, 3, 3> dc_da = dc_dn * cross_matrix<T>(e);
  const Mat<T, 3, 3> dc_de = n * e.transpose() / (length * n_sq) - dc_dn * cross_matrix<T>(a);
  const Vec<T, 3> dt_de = (a - T(2) * t * e) / e_sq;

  const int row = 3 * slot;
  out.grad.template segment<3>(row) += sign * c;
  out.grad.template segment<3>(0) -= sign * t * c;
  out.hess.template block<3, 3>(row, row) += sign * dc_da;
  out.hess.template block<3, 3>(row, 0) += sign * dc_de;
  out.hess.template block<3, 3>(0, row) += sign * dc_de.transpose();
  out.hess.template block<3, 3>(0, 0) -= sign * (c * dt_de.transpose() + t * dc_de);
}

/// Exact first and second derivative of the angle. Not finite when a triangle has no area.
/// Source: the gradient of Bridson et al. 2003 and Grinspun et al. 2003, differentiated once more; compare
/// Tamstorf and Grinspun 2013.
template <class T>
BB_HD HingeAngleTerms<T> hinge_angle_terms(const Vec<T, 3> (&x)[4]) {
  HingeAngleTerms<T> out;
  out.grad.setZero();
  out.hess.setZero();
  const Vec<T, 3> e = x[1] - x[0];
  add_hinge_side<T>(e, x[2] - x[0], T(-1), 1, out);
  add_hinge_side<T>(e, x[3] - x[0], T(1), 2, out);
  const Mat<T, 9, 9> transposed = out.hess.transpose();
  out.hess = T(0.5) * (out.hess + transposed);
  return out;
}

/// (A x 1_3) H (A x 1_3)^T for a small matrix A acting on points.
template <class T, int N>
BB_HD Mat<T, 3 * N, 3 * N> lift_points(const Mat<T, N, 3>& a, const Mat<T, 9, 9>& h) {
  Mat<T, 3 * N, 9> left;
  Mat<T, 3 * N, 3 * N> out;
  for (int i = 0; i < N; ++i) {
    left.template middleRows<3>(3 * i) = a(i, 0) * h.template middleRows<3>(0) +
                                         a(i, 1) * h.template middleRows<3>(3) +
                                         a(i, 2) * h.template middleRows<3>(6);
  }
  for (int i = 0; i < N; ++i) {
    out.template middleCols<3>(3 * i) = a(i, 0) * left.template middleCols<3>(0) +
                                        a(i, 1) * left.template middleCols<3>(3) +
                                        a(i, 2) * left.template middleCols<3>(6);
  }
  mirror_lower<T, 3 * N>(out);
  return out;
}

/// All points moved along the edge in proportion to where they lie along it, in the coordinates of `basis`,
/// m. Keeps normals, heights and every t of add_hinge_side, so the whole gradient of the angle: its Hessian
/// sends this motion to 0, and so does grad grad^T.
template <class T>
BB_HD Vec<T, 9> edge_stretch(const Vec<T, 3> (&x)[4], const Mat<T, 4, 3>& basis) {
  const Vec<T, 3> e = x[1] - x[0];
  const T length_sq = e.squaredNorm();
  Vec<T, 3> place = Vec<T, 3>::Zero();
  for (int i = 1; i < 4; ++i) {
    place += e.dot(Vec<T, 3>(x[i] - x[0])) / length_sq * basis.row(i).transpose();
  }
  Vec<T, 9> out;
  for (int k = 0; k < 3; ++k) out.template segment<3>(3 * k) = place[k] * e;
  return out;
}

/// Energy w(theta) of a hinge: w (J), w'' (J) and w'/w'' (rad), which is theta - theta0 where the energy is quadratic.
template <class T>
struct HingeEnergy {
  T energy, stiffness, deviation;
};

/// k/2 (theta - theta0)^2, k in J, angles in rad, the difference taken in (-pi, pi]. Host-device: yes.
template <class T>
BB_HD HingeEnergy<T> hinge_energy(const Vec<T, 3> (&x)[4], T stiffness, T rest_angle) {
  const T deviation = hinge_deviation<T>(hinge_angle<T>(x), rest_angle);
  return {stiffness / T(2) * deviation * deviation, stiffness, deviation};
}

/// The same with a stiffness that grows (stiffening.hpp): `exponential` J at rest, `exponent` 1/rad.
template <class T>
BB_HD HingeEnergy<T> hinge_energy(const Vec<T, 3> (&x)[4], T stiffness, T exponential, T exponent,
                                  T rest_angle) {
  if (!(exponential > T(0))) return hinge_energy<T>(x, stiffness, rest_angle);  // k u/k is not always u
  const T deviation = hinge_deviation<T>(hinge_angle<T>(x), rest_angle);
  const Stiffened<T> w = stiffened<T>(deviation, stiffness, exponential, exponent);
  return {w.energy, w.curvature, w.slope / w.curvature};
}

/// Whether the energy has a cusp at x: half a turn from rest, where it falls whichever way the hinge turns. Host-device: yes.
template <class T>
BB_HD bool hinge_is_cusp(const Vec<T, 3> (&x)[4], T stiffness, T rest_angle) {
  using std::abs;
  const T pi = T(3.14159265358979323846);
  return stiffness > T(0) && pi - abs(hinge_deviation<T>(hinge_angle<T>(x), rest_angle)) <=
                                 T(8) * std::numeric_limits<T>::epsilon();
}

/// The rest angle of a hinge after it has crept at x, rad. Host-device: yes.
/// @param rest_angle  rad, before     @param yield, kept  as those of crept()
template <class T>
BB_HD T crept_rest_angle(const Vec<T, 3> (&x)[4], T rest_angle, T yield, T kept) {
  const T turned = hinge_deviation<T>(hinge_angle<T>(x), rest_angle), left = crept(turned, yield, kept);
  return left != turned && left - left == T(0) ? rest_angle + (turned - left) : rest_angle;
}

/// Terms of a hinge whose energy has been taken: gradient and Hessian k (grad theta grad theta^T + w'/w'' grad^2 theta), k = w''.
/// Projections are those of the 12 x 12 matrix, done on the 8 x 8 matrix left when its null vectors, three translations
/// and the stretch along the edge, are split off. Not finite when a triangle has no area. Host-device: yes. Lanes: yes.
template <class T>
BB_HD ElementTerms<T, 12> hinge_terms_of(const Vec<T, 3> (&x)[4], const HingeEnergy<T>& of,
                                         Projection projection) {
  const T stiffness = of.stiffness, deviation = of.deviation;
  const HingeAngleTerms<T> angle = hinge_angle_terms<T>(x);
  const Mat<T, 9, 9> reduced = stiffness * (angle.grad * angle.grad.transpose() + deviation * angle.hess);
  Mat<T, 4, 3> difference;  // (e, a, b) = difference^T (e0, e1, v0, v1)
  difference << T(-1), T(-1), T(-1), T(1), T(0), T(0), T(0), T(1), T(0), T(0), T(0), T(1);

  ElementTerms<T, 12> out;
  out.energy = of.energy;
  for (int i = 0; i < 4; ++i) {
    out.grad.template segment<3>(3 * i) = stiffness * deviation *
                                          (difference(i, 0) * angle.grad.template segment<3>(0) +
                                           difference(i, 1) * angle.grad.template segment<3>(3) +
                                           difference(i, 2) * angle.grad.template segment<3>(6));
  }
  const MaskOf<T> flat = deviation == T(0);  // then k grad grad^T is PSD without projection
  if (projection == Projection::none || any(flat)) out.hess = lift_points<T, 4>(difference, reduced);
  if (projection != Projection::none && any(!flat)) {
    Mat<T, 4, 3> basis;  // orthonormal, at right angles to (1, 1, 1, 1)
    basis << T(1), T(1), T(1), T(1), T(-1), T(-1), T(-1), T(1), T(-1), T(-1), T(-1), T(1);
    basis *= T(0.5);
    const Mat<T, 3, 3> to_basis = basis.transpose() * difference;
    const Mat<T, 12, 12> projected = lift_points<T, 4>(
        basis,
        project_beside<T, 9>(lift_points<T, 3>(to_basis, reduced), edge_stretch<T>(x, basis), projection));
    out.hess = any(flat) ? select_entries(flat, out.hess, projected) : projected;
  }
  return out;
}

/// Energy, gradient and Hessian of a hinge; `of` as hinge_energy() takes it behind x: {stiffness, rest_angle}, or with what grows.
template <class T, class... Of>
BB_HD ElementTerms<T, 12> hinge_terms(const Vec<T, 3> (&x)[4], Projection projection, Of... of) {
  return hinge_terms_of<T>(x, hinge_energy<T>(x, of...), projection);
}

// Compiled once for these scalars, in element_terms.cpp: kernels that call it are in headers of many files.
#ifndef __CUDACC__
extern template ElementTerms<float, 12> hinge_terms_of<float>(const Vec<float, 3> (&)[4],
                                                              const HingeEnergy<float>&, Projection);
extern template ElementTerms<double, 12> hinge_terms_of<double>(const Vec<double, 3> (&)[4],
                                                                const HingeEnergy<double>&, Projection);
#endif

}  // namespace bb
