// Closest points in exact integers: the oracle of core/geometry. Shares no formula with it: every pair of faces of the two
// primitives is a least-squares problem solved by Gram determinants, and the least feasible one wins.
#pragma once

#include <gmpxx.h>

#include <array>
#include <vector>

#include "core/geometry/pair.hpp"
#include "core/geometry/region.hpp"
#include "core/math/types.hpp"

namespace bb::test {

/// The points of a pair as integers times 2^exponent (exact for every finite double).
struct ExactPair {
  using Point = std::array<mpz_class, 3>;
  std::vector<Point> x;
  int split = 1;  // points of the first primitive
  long exponent = 0;
};

ExactPair exact_pair(const Eigen::Ref<const Mat<double, 3, Eigen::Dynamic>>& x, int split);

/// Squared distance as a fraction of squared integer units, den > 0.
struct ExactDistance {
  mpz_class num, den;
  unsigned faces = 0;  // bit i: point i takes part; of the first pair of faces that has the least distance
};

/// Over the closed faces that the points in `within` span (all by default).
ExactDistance exact_distance(const ExactPair& pair, unsigned within = ~0U);

/// The points that a region names as a set of bits.
unsigned region_points(Region region);

/// |sum_i weights_i (x_i - x_0)|^2 without rounding. Measured from x_0, since rounded weights of a primitive do not add up
/// to 1 exactly, and far from the origin that would count for more than the weights themselves.
ExactDistance exact_combination(const ExactPair& pair, const std::vector<double>& weights);

/// (value - sqrt(num/den) 2^exponent)/unit, computed with 256 bits; a unit of 0 gives the difference itself.
double error_in(double unit, double value, const ExactDistance& distance, long exponent);
/// (sqrt(a) - sqrt(b)) 2^exponent/unit.
double excess_in(double unit, const ExactDistance& a, const ExactDistance& b, long exponent);

}  // namespace bb::test
