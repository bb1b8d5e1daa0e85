// The friction of the cubic-barrier paper (Ando 2024): a spring between the points until its force is mu times the load.
#pragma once

#include "core/energy/friction_laws/profile.hpp"

namespace bb::friction_laws {

/// The paper states a force, mu load y/max(eps, y). With load, normal and weights held fixed it has the potential
/// f0 = (eps + y^2/eps)/2 below eps, f1 = y/eps, whose curvature jumps at eps. The paper's matrix takes mu load/max(eps, y) in
/// both tangential directions, which is that of the whole secant; f2 = 0 beyond eps is the exact one, smaller along the slide. Host-device.
struct capped {
  static constexpr bool two_coefficients = false;
  template <class T>
  BB_HD static FrictionProfile<T> eval(T y, const SlideScales<T>& of) {
    if (y >= of.eps) return full_friction(y);
    const T r = y / of.eps;
    return {of.eps * (T(1) + r * r) / T(2), T(1) / of.eps, T(1) / of.eps};
  }
};

}  // namespace bb::friction_laws
