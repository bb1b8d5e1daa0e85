// Friction of one contact over one time step (docs/theory/friction.md): mu load f0(|u|), u the slide of its two closest points
// in the tangent plane. Load, normal and weights are those of the lagged contact state, so this is one function of x, convex with one coefficient.
#pragma once

#include <cmath>
#include <limits>

#include "core/energy/friction_laws/profile.hpp"
#include "core/energy/terms.hpp"

namespace bb {

/// What is left of a relative motion (m) in the plane across the unit normal. Host-device.
template <class T>
BB_HD inline Vec<T, 3> slide_of(const Vec<T, 3>& motion, const Vec<T, 3>& normal) {
  return motion - normal.dot(motion) * normal;
}

/// In the relative motion of the closest points.
template <class T>
struct MotionTerms {
  T energy;        // J
  Vec<T, 3> grad;  // N
  Mat<T, 3, 3>
      hess;  // N/m, symmetric bit for bit, no eigenvalue below rounding where f2 >= 0: exact and clamped are one
};

/// slide: across the unit normal, of length y (m); strength = mu times load (N); profile: that of y. The matrix is strength
/// (f2 t t^T + f1/y b b^T), t along the slide and b across it; both are the same for slides that are nothing beside eps, which
/// have no direction. Host-device. Total.
template <class T>
BB_HD inline MotionTerms<T> friction_terms(const Vec<T, 3>& slide, T y, const Vec<T, 3>& normal, T strength,
                                           const FrictionProfile<T>& profile) {
  const T turning = strength * profile.f1_over_y, along = strength * profile.f2;
  MotionTerms<T> out{strength * profile.f0, turning * slide, {}};
  if (y * profile.f1_over_y > std::numeric_limits<T>::epsilon()) {
    const Vec<T, 3> t = slide / y, b = normal.cross(t);
    out.hess = along * (t * t.transpose()) + turning * (b * b.transpose());
  } else {
    out.hess = turning * (Mat<T, 3, 3>::Identity() - normal * normal.transpose());
  }
  mirror_lower<T, 3>(out.hess);
  return out;
}

/// A law of core/energy/friction_laws as a term takes it: f2 is that of the matrix, 0 where the law has a negative one, so that the
/// matrix has no negative eigenvalue. secant in [0, 1]: the share of f1/y in the place of f2. With the whole of
/// it the quadratic model of the energy lies nowhere below the energy, since f1/y falls with y under every law (lagged
/// diffusivity; Vogel and Oman 1996 for total variation): a slide that turns round within the step is modelled as one that
/// brakes, where the exact matrix has no stiffness along a slide beyond eps.
template <class Law, class T>
struct LawInTerm {
  SlideScales<T> of;
  T secant = 0;
  BB_HD FrictionProfile<T> operator()(T y) const {
    FrictionProfile<T> out = Law::template eval<T>(y, of);
    if constexpr (Law::two_coefficients) {
      if (out.f2 < T(0)) out.f2 = T(0);
    }
    out.f2 += secant * (out.f1_over_y - out.f2);
    return out;
  }
};

/// friction_terms with the length of the slide and its profile. law(y): FrictionProfile<T>. Host-device.
template <class T, class Law>
BB_HD inline MotionTerms<T> friction_of_slide(const Vec<T, 3>& slide, const Vec<T, 3>& normal, T strength,
                                              const Law& law) {
  const T y = slide.norm();
  return friction_terms<T>(slide, y, normal, strength, law(y));
}
/// Its energy alone, J.
template <class T, class Law>
BB_HD inline T friction_value(const Vec<T, 3>& slide, T strength, const Law& law) {
  return strength * law(slide.norm()).f0;
}
/// Work of the force along a slide of length y, J: what is dissipated.
template <class T, class Law>
BB_HD inline T friction_work(T y, T strength, const Law& law) {
  return strength * law(y).f1_over_y * y * y;
}

/// The same in N points, of whose motions sum w_i dx_i is the relative one: gradient w_i g, blocks w_i w_j H. Host-device.
template <class T, int N>
BB_HD inline ElementTerms<T, 3 * N> motion_in_points(const MotionTerms<T>& terms, const Vec<T, N>& weights) {
  ElementTerms<T, 3 * N> out;
  out.energy = terms.energy;
  for (int i = 0; i < N; ++i) {
    out.grad.template segment<3>(3 * i) = weights[i] * terms.grad;
    for (int j = 0; j < N; ++j) {
      out.hess.template block<3, 3>(3 * i, 3 * j) = (weights[i] * weights[j]) * terms.hess;
    }
  }
  return out;
}

}  // namespace bb
