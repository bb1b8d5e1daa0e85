// Closest points and time of impact of coordinates of any size. Distances multiply up to six lengths, which leaves the range
// of a number below 1e-51 and above 1e51 m (float: 5e-7 and 2e6 m). Such points are brought to size 1 by a power of two, which
// rounds nothing; all others are left as they are, for the very functions that the pipeline runs.
#pragma once

#include <cmath>
#include <limits>

#include "core/geometry/accd.hpp"
#include "core/geometry/closest_points.hpp"

namespace bb::eval {

/// What points of this largest |coordinate| are multiplied by: 1, or a power of two that brings it into [1/2, 1).
/// As two factors, since one alone may be no finite number.
template <class T>
struct Scale {
  T first = 1, second = 1;

  explicit Scale(T largest) {
    constexpr int widest = std::numeric_limits<T>::max_exponent / 6;
    if (!(largest > T(0))) return;
    int exponent = 0;
    std::frexp(largest, &exponent);
    if (exponent <= widest && exponent >= -widest) return;
    first = std::ldexp(T(1), -exponent / 2);
    second = std::ldexp(T(1), -exponent - (-exponent / 2));
  }
  T of(T value) const { return value * first * second; }
  T back(T value) const { return value / first / second; }
  template <int N>
  Mat<T, 3, N> of(const Mat<T, 3, N>& x) const {
    return (x * first) * second;
  }
};

/// Closest points of x; r and d are those of the scaled points.
template <class T, int N>
struct ScaledClosest {
  Scale<T> scale;
  Closest<T, N> closest;
};

template <PairKind K, class T>
ScaledClosest<T, pair_points(K)> closest_at_any_scale(const Mat<T, 3, pair_points(K)>& x) {
  const Scale<T> scale(x.cwiseAbs().maxCoeff());
  return {scale, closest_points<K, T>(scale.of(x))};
}

/// accd of the scaled motion. Where the motion is longer than the start by more than T resolves, the start alone decides whether it
/// overlaps.
template <PairKind K, class T>
AccdResult<T> accd_at_any_scale(const Mat<T, 3, pair_points(K)>& x0, const Mat<T, 3, pair_points(K)>& x1,
                                T offset, T park) {
  const T at0 = x0.cwiseAbs().maxCoeff(), at1 = x1.cwiseAbs().maxCoeff();
  const Scale<T> scale(at0 > at1 ? at0 : at1);
  AccdResult<T> result = accd<K, T>(scale.of(x0), scale.of(x1), scale.of(offset), scale.of(park));
  if (result.overlap_at_start) {
    const ScaledClosest<T, pair_points(K)> start = closest_at_any_scale<K, T>(x0);
    result.overlap_at_start = !(start.closest.d > start.scale.of(offset));
  }
  return result;
}

}  // namespace bb::eval
