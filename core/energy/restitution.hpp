// Restitution: how much a contact has to damp so that two bodies part with a given share of the speed at which they met, and the
// damping itself.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/energy/friction.hpp"

namespace bb {

/// A contact pushes with load (1 + a v) (Hunt and Crossley 1975, J. Appl. Mech. 42): v is the speed at which the gap closes, m/s,
/// and the load depends on the gap alone. Then m v dv/(1 + a v) is -load dgap, and on the way in and on the way out the same work
/// is done, so that v_in and e v_in obey y - log(1 + y) = -e y - log(1 - e y) with y = a v_in, whatever load and mass are.
/// @param e  share of the speed that is kept, 1; below 0.01 taken for 0.01
/// @return   y, 1: 0 for e >= 1, about 1/e for small e
inline double restitution_damping(double e) {
  if (e >= 1) return 0;
  const double kept = std::max(e, 0.01);
  const auto excess = [kept](double y) { return (y - std::log1p(y)) + (kept * y + std::log1p(-kept * y)); };
  double low = 0, high = 1 / kept;  // above 0 near 0, falls without bound towards 1/e
  for (int k = 0; k < 100; ++k) {
    const double middle = (low + high) / 2;
    (excess(middle) > 0 ? low : high) = middle;
  }
  return low;
}

/// The damping of one contact in a step of length h, against the way (m) by which its gap opens. A contact pushes and never pulls: what
/// holds an opening gap back is `load` at most, all that the contact pushes with.
template <class T>
struct ContactDamping {
  T k;     // load a/h, N/m
  T load;  // N, >= 0; 0 only where k is 0

  /// N, against the way.
  BB_HD T force(T way) const { return yields(way) ? load : k * way; }
  /// J. Convex, with a continuous derivative.
  BB_HD T energy(T way) const {
    return yields(way) ? load * (way - load / (T(2) * k)) : k / T(2) * way * way;
  }
  BB_HD T stiffness(T way) const { return yields(way) ? T(0) : k; }

 private:
  BB_HD bool yields(T way) const { return k * way > load; }
};

/// Its energy in a relative motion (m) along the unit normal n. Host-device. Total.
template <class T>
BB_HD inline MotionTerms<T> damping_terms(const Vec<T, 3>& motion, const Vec<T, 3>& n,
                                          const ContactDamping<T>& of) {
  const T way = motion.dot(n);
  MotionTerms<T> terms{of.energy(way), of.force(way) * n, of.stiffness(way) * n * n.transpose()};
  mirror_lower<T, 3>(terms.hess);
  return terms;
}
/// That energy alone, J.
template <class T>
BB_HD inline T damping_value(const Vec<T, 3>& motion, const Vec<T, 3>& n, const ContactDamping<T>& of) {
  return of.energy(motion.dot(n));
}
/// Force times way, J.
template <class T>
BB_HD inline T damping_work(const Vec<T, 3>& motion, const Vec<T, 3>& n, const ContactDamping<T>& of) {
  const T way = motion.dot(n);
  return of.force(way) * way;
}

}  // namespace bb
