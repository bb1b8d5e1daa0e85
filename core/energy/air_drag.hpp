// Drag of the air on a triangle: what its corners bear against their velocity relative to the wind.
#pragma once

#include "core/math/types.hpp"

namespace bb {

/// The part A/3 (c_t 1 + (c_n - c_t) n n^T) of a corner, N s/m, of a triangle with area A and normal n; 0 of one without area.
/// normal, tangential: c_n and c_t, N s/m^3. Host-device: yes. Total.
template <class T>
BB_HD Mat<T, 3, 3> drag_of_corner(const Vec<T, 3> (&x)[3], T normal, T tangential) {
  const Vec<T, 3> first = x[1] - x[0], second = x[2] - x[0], twice = first.cross(second);
  const T length = twice.norm();
  if (!(length > T(0))) return Mat<T, 3, 3>::Zero();
  const Vec<T, 3> n = twice / length;
  return length / T(6) *
         (tangential * Mat<T, 3, 3>::Identity() + (normal - tangential) * (n * n.transpose()));
}

}  // namespace bb
