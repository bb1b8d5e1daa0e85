// From double to float, outward: what a float box holds is never less than what it was made from.
#pragma once

#include <cmath>

#include "core/math/precision.hpp"

namespace bb {

/// How far a distance that is evaluated in the precision's scalar can be from that of the points before they were
/// rounded, m, for coordinates up to `largest`: two states rounded, differences, and the closest points of them, with
/// a margin to spare. 0 in double, where whoever rejects a pair has a margin of its own.
inline double distance_rounding(Precision precision, double largest) {
  return values_in_float(precision) ? 64 * value_epsilon(precision) * largest : 0;
}

/// More than what the rounding of a number of that size to float takes away. Of a number, or of a vector of them.
template <class T>
BB_HD T room_of_rounding(const T& size) {
  return size * 0x1p-23 + 0x1p-140;
}
/// The largest float that is at most x and the smallest that is at least x, or a neighbour of those.
BB_HD inline float float_below(double x) { return static_cast<float>(x - room_of_rounding(std::abs(x))); }
BB_HD inline float float_above(double x) { return -float_below(-x); }

}  // namespace bb
