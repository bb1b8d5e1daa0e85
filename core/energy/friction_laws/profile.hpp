// What a friction law says of a slide: a potential f0 of its length y, whose slope f1 = f0' is the part of mu times the load
// that pushes back, from 0 at rest to 1.
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

/// The whole force, from eps on, under every law. Host-device.
template <class T>
BB_HD inline FrictionProfile<T> full_friction(T y) {
  return {y, T(1) / y, T(0)};
}

}  // namespace bb
