// Friction with a static and a lower kinetic coefficient, which a contact that slides faster comes down to (Stribeck 1902).
#pragma once

#include "core/energy/friction_laws/profile.hpp"

namespace bb::friction_laws {

/// Below eps smoothed Coulomb friction with the static coefficient. From there to reach the coefficient falls by the cubic
/// s = t^2 (3 - 2 t), t = (y - eps)/(reach - eps), to the kinetic one: f1 = 1 - (1 - k) s, f0 = y - (1 - k) (reach - eps) (t^3 - t^4/2).
/// The cubic is that of smooth_mu in the IPC toolkit, which falls below eps already, where f1 grows: there no slide is held by more
/// than a part of the static coefficient (0.57 of it with k = 1/2). Here all of it is reached, at eps. f1 is continuous with its
/// slope, which is negative between eps and reach: f0 is not convex there. Host-device.
struct static_kinetic {
  static constexpr bool two_coefficients = true;
  template <class T>
  BB_HD static FrictionProfile<T> eval(T y, const SlideScales<T>& of) {
    if (y < of.eps) return smoothed_friction(y, of.eps);
    const T width = of.reach - of.eps, drop = T(1) - of.kinetic;
    if (y >= of.reach) return {y - drop * (y - of.reach + width / T(2)), of.kinetic / y, T(0)};
    const T t = (y - of.eps) / width, t2 = t * t;
    return {y - drop * width * t2 * t * (T(1) - t / T(2)), (T(1) - drop * t2 * (T(3) - T(2) * t)) / y,
            -drop * T(6) * t * (T(1) - t) / width};
  }
};

}  // namespace bb::friction_laws
