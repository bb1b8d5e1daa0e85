// Coulomb friction with a smooth start (Li et al. 2020, Incremental Potential Contact).
#pragma once

#include "core/energy/friction_laws/profile.hpp"

namespace bb::friction_laws {

/// Below eps, with r = y/eps: f0 = eps (1/3 + r^2 - r^3/3), f1 = 2 r - r^2. f1 and f2 are continuous at eps. Host-device.
struct smoothed_coulomb {
  template <class T>
  BB_HD static FrictionProfile<T> eval(T y, T eps) {
    if (y >= eps) return full_friction(y);
    const T r = y / eps;
    return {eps * (T(1) / T(3) + r * r * (T(1) - r / T(3))), (T(2) - r) / eps, T(2) * (T(1) - r) / eps};
  }
};

}  // namespace bb::friction_laws
