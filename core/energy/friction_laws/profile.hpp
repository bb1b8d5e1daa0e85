// What a friction law states of a slide: a potential f0 of its length y, whose slope f1 = f0' is the part of mu times the load
// that pushes back, from 0 at rest to 1; mu is the static coefficient where there are two.
#pragma once

#include "core/math/types.hpp"

namespace bb {

/// f0 and what its first two derivatives become in three dimensions, at one length y >= 0.
template <class T>
struct FrictionProfile {
  T f0;         // m
  T f1_over_y;  // 1/m, its limit at y = 0
  T f2;         // 1/m
};

/// What the slides of one contact are measured by in a step. eps > 0: from which length on the force is whole. The rest is of laws with
/// two coefficients, which fall from the static to the kinetic one between eps and reach.
template <class T>
struct SlideScales {
  T eps;          // m
  T kinetic = 1;  // of the static coefficient, in [0, 1]
  T reach = 0;    // m, > eps
};

/// The whole force, from eps on, under every law of one coefficient. Host-device.
template <class T>
BB_HD inline FrictionProfile<T> full_friction(T y) {
  return {y, T(1) / y, T(0)};
}

/// Below eps of smoothed Coulomb friction (Li et al. 2020), with r = y/eps: f0 = eps (1/3 + r^2 - r^3/3), f1 = 2 r - r^2. Host-device.
template <class T>
BB_HD inline FrictionProfile<T> smoothed_friction(T y, T eps) {
  const T r = y / eps;
  return {eps * (T(1) / T(3) + r * r * (T(1) - r / T(3))), (T(2) - r) / eps, T(2) * (T(1) - r) / eps};
}

}  // namespace bb
