// Pairs that make closest points hard, by family; seeded.
#pragma once

#include <random>

#include "core/geometry/pair.hpp"
#include "core/math/types.hpp"

namespace bb::test {

enum class Family {
  random,
  needle,    // thin triangles and short edges, down to 1e-15 of their length
  no_area,   // collinear corners, edges without length
  parallel,  // edges at 1e-1 to 1e-7 rad and exactly parallel; points over edges
  coplanar,
  coincident,  // shared points
  offset,      // far from the origin: 1e1 to 1e6 sizes
  mixed,       // every point on a scale of its own, 1e-6 to 1
  obtuse,      // apex of 60 to 179.99 degrees
  small_gap,   // 1e-2 to 1e-15 above the inside
  large,       // 1e8 m in double, 1e4 m in float
  tiny,        // 1e-60 m in double, 1e-7 m in float: the smallest whose fourth powers are normal numbers
  denormal     // below that, down to denormal numbers
};
inline constexpr int n_families = 13;
const char* family_name(Family family);

/// Coordinates that T holds exactly, as doubles. @return [3 x 4]; a pair of fewer points uses the first columns.
Mat<double, 3, 4> hard_pair(Family family, PairKind kind, bool in_float, std::mt19937_64& random);

}  // namespace bb::test
