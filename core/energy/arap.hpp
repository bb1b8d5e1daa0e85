// As-rigid-as-possible membrane density: corotational without its volume term.
#pragma once

#include "core/energy/corotational.hpp"

namespace bb {

/// psi = mu sum (s-1)^2; lambda is not used. Host-device: yes. Total.
struct Arap {
  template <class T>
  BB_HD static Density2<T> eval(const Vec<T, 2>& s, T lame_mu, T /*lame_lambda*/) {
    return Corotational::eval<T>(s, lame_mu, T(0));
  }
};

namespace membrane {
using arap = Isotropic<Arap>;
}

}  // namespace bb
