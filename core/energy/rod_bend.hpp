// Bending of a rod at the vertex p1 between its segments p0 p1 and p1 p2: quadratic in the angle between them.
#pragma once

#include <cmath>
#include <limits>

#include "core/energy/terms.hpp"
#include "core/math/atan2.hpp"
#include "core/math/congruence.hpp"
#include "core/math/psd.hpp"

namespace bb {

/// Two segments of a rod in an orthonormal frame: the first along `along`, the second along
/// cosine along + sine towards; `across` is normal to both.
template <class T>
struct RodCorner {
  T length_a, length_b;  // m, of the segments p0 p1 and p1 p2
  T angle;               // rad, in [0, pi]; 0 when straight
  T sine, cosine;        // of the angle, sine >= 0
  Vec<T, 3> along, towards, across;
};

/// Angle in [0, pi] between two vectors, by atan2, so that it keeps its digits near 0 and pi. Host-device: yes. Total.
template <class T>
BB_HD T angle_between(const Vec<T, 3>& a, const Vec<T, 3>& b) {
  using elementary::atan2;
  return atan2(a.cross(b).norm(), a.dot(b));
}

/// Rest angles below are those of a straight rod whose coordinates are rounded.
constexpr double least_rest_angle = 1e-6;  // rad
/// Whether two segments can be the rest shape of a rod: both have a length, and they do not fold back on each other.
inline bool can_rest(const Vec3d& a, const Vec3d& b) {
  return a.norm() > 0 && b.norm() > 0 && angle_between(a, b) <= 3.14159265358979323846 - least_rest_angle;
}
/// The angle at rest of two segments a, b (m) of a rod, rad.
inline double rod_rest_angle(const Vec3d& a, const Vec3d& b) {
  const double angle = angle_between(a, b);
  return angle < least_rest_angle ? 0 : angle;
}

/// A unit vector at right angles to the unit vector n.
template <class T>
BB_HD Vec<T, 3> any_normal_to(const Vec<T, 3>& n) {
  Eigen::Index least = 0;
  for (Eigen::Index k = 1; k < 3; ++k) {
    if (n[k] * n[k] < n[least] * n[least]) least = k;
  }
  return n.cross(Vec<T, 3>(Vec<T, 3>::Unit(least))).normalized();
}

/// Where the segments are on one line, any plane that holds it is theirs. Not finite when two points coincide. Host-device: yes.
template <class T>
BB_HD RodCorner<T> rod_corner(const Vec<T, 3> (&x)[3]) {
  const Vec<T, 3> a = x[1] - x[0], b = x[2] - x[1], normal = a.cross(b);
  RodCorner<T> out;
  out.length_a = a.norm();
  out.length_b = b.norm();
  out.angle = angle_between<T>(a, b);
  out.sine = normal.norm() / (out.length_a * out.length_b);
  out.cosine = a.dot(b) / (out.length_a * out.length_b);
  out.along = a / out.length_a;
  // The cross product of nearly parallel segments is not at right angles to them, for rounding; its part along them goes.
  const Vec<T, 3> unit = normal.norm() > T(0) ? Vec<T, 3>(normal.normalized()) : any_normal_to<T>(out.along);
  const Vec<T, 3> across = unit - out.along.dot(unit) * out.along;
  out.across =
      across.norm() > T(0.5) ? Vec<T, 3>(across.normalized()) : Vec<T, 3>(any_normal_to<T>(out.along));
  out.towards = out.across.cross(out.along);
  return out;
}

/// Whether the energy has a cusp here: the plane of the angle, into which the force points, is not known within rounding, and
/// the force does not vanish. The straight corner is none when it is at rest. Host-device: yes.
template <class T>
BB_HD bool is_rod_cusp(const RodCorner<T>& corner, T rest_angle) {
  if (rest_angle == T(0) && corner.cosine > T(0)) return false;
  return !(corner.sine > T(4) * std::numeric_limits<T>::epsilon());
}

/// The Hessian over k of the corner in its frame, on what moves a = p1 - p0 and b = p2 - p1.
template <class T>
struct RodHessian {
  Mat<T, 4, 4> in_plane;  // (along, towards) of a, then of b, 1/m^2
  Mat<T, 2, 2> across;    // across of a, of b, 1/m^2
};

/// Gradient of the angle in the order of RodHessian::in_plane, 1/m. Across the plane it is 0.
template <class T>
BB_HD Vec<T, 4> rod_angle_gradient(const RodCorner<T>& c) {
  return Vec<T, 4>(T(0), T(-1) / c.length_a, -c.sine / c.length_b, c.cosine / c.length_b);
}

/// grad grad^T + deviation times the Hessian of the angle. That of a geodesic distance on the unit sphere: within the plane only
/// the change of length with the direction is left; across it cot(angle) for each end and -1/sin(angle) between them.
template <class T>
BB_HD RodHessian<T> rod_hessian(const RodCorner<T>& c, T deviation, T rest_angle) {
  const Vec<T, 4> grad = rod_angle_gradient<T>(c);
  const T la = c.length_a, lb = c.length_b;
  // deviation/sine, whose limit at a straight corner at rest is 1
  const T ratio = rest_angle == T(0) && !(c.sine > T(0)) ? T(1) : deviation / c.sine;
  const T double_sine = T(2) * c.sine * c.cosine, double_cosine = c.cosine * c.cosine - c.sine * c.sine;
  RodHessian<T> out;
  out.in_plane = grad * grad.transpose();
  out.in_plane(0, 1) += deviation / (la * la);
  out.in_plane(1, 0) += deviation / (la * la);
  Mat<T, 2, 2> b;
  b << double_sine, -double_cosine, -double_cosine, -double_sine;
  out.in_plane.template bottomRightCorner<2, 2>() += deviation / (lb * lb) * b;
  const T cross = -ratio / (la * lb);
  out.across << ratio * c.cosine / (la * la), cross, cross, ratio * c.cosine / (lb * lb);
  return out;
}

/// At a cusp: the mean of grad grad^T over all planes through the line.
template <class T>
BB_HD RodHessian<T> rod_cusp_hessian(const RodCorner<T>& c) {
  const T end = c.cosine < T(0) ? T(-1) : T(1);
  const Vec<T, 2> grad(T(-1) / c.length_a, end / c.length_b);
  RodHessian<T> out;
  out.across = T(0.5) * grad * grad.transpose();
  out.in_plane.setZero();
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) out.in_plane(2 * i + 1, 2 * j + 1) = out.across(i, j);
  }
  return out;
}

/// stiffness h on the three points, projected as their 9 x 9 matrix: translations are split off, and what is left falls apart into
/// the plane of the corner and the direction across it.
template <class T>
BB_HD Mat<T, 9, 9> rod_point_hessian(const RodCorner<T>& corner, const RodHessian<T>& h, T stiffness,
                                     Projection projection) {
  using std::sqrt;
  const T r2 = T(1) / sqrt(T(2)), r6 = T(1) / sqrt(T(6));
  Mat<T, 3, 2> basis;  // orthonormal, at right angles to (1, 1, 1)
  basis << -r2, r6, T(0), T(-2) * r6, r2, r6;
  Mat<T, 2, 2> change;  // (a, b) = change of the coordinates in the basis
  for (int k = 0; k < 2; ++k) {
    change(0, k) = basis(1, k) - basis(0, k);
    change(1, k) = basis(2, k) - basis(1, k);
  }
  Mat<T, 4, 4> both;
  for (int i = 0; i < 2; ++i) {
    for (int k = 0; k < 2; ++k) {
      both.template block<2, 2>(2 * i, 2 * k) = change(i, k) * Mat<T, 2, 2>::Identity();
    }
  }
  Mat<T, 4, 4> in_plane = stiffness * (both.transpose() * h.in_plane * both);
  Mat<T, 2, 2> across = stiffness * (change.transpose() * h.across * change);
  mirror_lower<T, 4>(in_plane);
  mirror_lower<T, 2>(across);
  in_plane = project<T, 4>(in_plane, projection);
  across = project<T, 2>(across, projection);

  Mat<T, 9, 4> to_plane;
  Mat<T, 9, 2> to_across;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 2; ++k) {
      to_plane.template block<3, 1>(3 * i, 2 * k) = basis(i, k) * corner.along;
      to_plane.template block<3, 1>(3 * i, 2 * k + 1) = basis(i, k) * corner.towards;
      to_across.template block<3, 1>(3 * i, k) = basis(i, k) * corner.across;
    }
  }
  Mat<T, 9, 9> out = congruence<T, 9, 4>(to_plane, in_plane) + congruence<T, 9, 2>(to_across, across);
  mirror_lower<T, 9>(out);
  return out;
}

/// Energy (J) k/2 (theta - theta0)^2, theta the angle between p1 - p0 and p2 - p1, k in J, angles in rad. NaN when two neighbours
/// coincide, as the terms are. Host-device: yes.
template <class T>
BB_HD T rod_bend_value(const Vec<T, 3> (&x)[3], T stiffness, T rest_angle) {
  const Vec<T, 3> a = x[1] - x[0], b = x[2] - x[1];
  if (a.isZero(T(0)) || b.isZero(T(0))) return std::numeric_limits<T>::quiet_NaN();
  const T deviation = angle_between<T>(a, b) - rest_angle;
  return stiffness / T(2) * deviation * deviation;
}

/// Energy, gradient and Hessian k (grad theta grad theta^T + (theta - theta0) grad^2 theta). Smooth where a straight rod at rest is
/// straight, since theta^2 is. At the other cusps (theta 0 with theta0 not 0, theta pi) the gradient is 0, the mean of its limits
/// over all planes, and the Hessian k times that mean of grad theta grad theta^T. Not finite when two neighbours coincide.
/// Host-device: yes.
template <class T>
BB_HD ElementTerms<T, 9> rod_bend_terms(const Vec<T, 3> (&x)[3], T stiffness, T rest_angle,
                                        Projection projection) {
  const RodCorner<T> corner = rod_corner<T>(x);
  const T deviation = corner.angle - rest_angle;
  const bool cusp = is_rod_cusp<T>(corner, rest_angle);
  const Vec<T, 4> grad = (cusp ? T(0) : stiffness * deviation) * rod_angle_gradient<T>(corner);
  const Vec<T, 3> of_a = grad[0] * corner.along + grad[1] * corner.towards;
  const Vec<T, 3> of_b = grad[2] * corner.along + grad[3] * corner.towards;

  ElementTerms<T, 9> out;
  out.energy = rod_bend_value<T>(x, stiffness, rest_angle);
  out.grad << -of_a, of_a - of_b, of_b;
  out.hess = rod_point_hessian<T>(
      corner, cusp ? rod_cusp_hessian<T>(corner) : rod_hessian<T>(corner, deviation, rest_angle), stiffness,
      projection);
  return out;
}

/// Whether the energy has a cusp at x and falls whichever way the rod leaves its line: a corner folded back (theta = pi), or straight
/// where it is curved at rest. Host-device: yes.
template <class T>
BB_HD bool rod_bend_is_cusp(const Vec<T, 3> (&x)[3], T stiffness, T rest_angle) {
  using std::abs;
  const RodCorner<T> corner = rod_corner<T>(x);
  return stiffness > T(0) && is_rod_cusp<T>(corner, rest_angle) &&
         abs(corner.angle - rest_angle) > T(8) * std::numeric_limits<T>::epsilon();
}

// Compiled once for these scalars, in element_terms.cpp: kernels that call it are in headers of many files.
#ifndef __CUDACC__
extern template ElementTerms<float, 9> rod_bend_terms<float>(const Vec<float, 3> (&)[3], float, float,
                                                             Projection);
extern template ElementTerms<double, 9> rod_bend_terms<double>(const Vec<double, 3> (&)[3], double, double,
                                                               Projection);
#endif

}  // namespace bb
