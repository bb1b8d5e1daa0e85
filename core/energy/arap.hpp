// As-rigid-as-possible density of triangles and tetrahedra: corotational without its volume term.
#pragma once

#include "core/energy/corotational.hpp"

namespace bb {

/// psi = mu sum (s-1)^2; lambda is not used. Host-device: yes. Total.
struct Arap {
  template <class T, int N>
  BB_HD static Density<T, N> eval(const Vec<T, N>& s, T lame_mu, T /*lame_lambda*/) {
    return Corotational::eval<T, N>(s, lame_mu, T(0));
  }
};

namespace membrane {
using arap = Isotropic<Arap>;
}
namespace solid {
using arap = Isotropic<Arap>;
}

}  // namespace bb
