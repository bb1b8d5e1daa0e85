// Coulomb friction with a smooth start (Li et al. 2020, Incremental Potential Contact).
#pragma once

#include "core/energy/friction_laws/profile.hpp"

namespace bb::friction_laws {

/// f1 and f2 are continuous at eps. Host-device.
struct smoothed_coulomb {
  static constexpr bool two_coefficients = false;
  template <class T>
  BB_HD static FrictionProfile<T> eval(T y, const SlideScales<T>& of) {
    if (y >= of.eps) return full_friction(y);
    return smoothed_friction(y, of.eps);
  }
};

}  // namespace bb::friction_laws
