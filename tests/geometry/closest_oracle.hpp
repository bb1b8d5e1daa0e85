// Closest points by enumeration in long double: every pair of faces of the two simplices is solved by dense
// linear algebra, the best feasible one wins. Shares no formula with core/geometry.
#pragma once

#include <limits>
#include <random>
#include <string>

#include "core/geometry/closest_points.hpp"

namespace bb::test {

using Long = long double;
template <class T, int N>
using Points = Mat<T, 3, N>;

template <int N>
struct OracleClosest {
  Long d = std::numeric_limits<Long>::infinity();
  Vec<Long, N> weights = Vec<Long, N>::Zero();
  Vec<Long, 3> r = Vec<Long, 3>::Zero();
  Long least_weight = 0;  // of the chosen faces: how far from the border of its region
};

/// Over the first n columns, of which the first `split` are the first primitive; weights beyond n are 0.
OracleClosest<4> enumerate_faces(const Points<Long, 4>& x, int n, int split);

template <PairKind K, class T>
OracleClosest<pair_points(K)> oracle_closest(const Points<T, pair_points(K)>& x) {
  constexpr int N = pair_points(K);
  Points<Long, 4> padded = Points<Long, 4>::Zero();
  padded.template leftCols<N>() = x.template cast<Long>();
  const OracleClosest<4> best = enumerate_faces(padded, N, pair_split(K));
  return {best.d, best.weights.template head<N>(), best.r, best.least_weight};
}

/// The word of the region in which exactly these weights are not zero.
template <PairKind K>
std::string region_word(const Vec<Long, pair_points(K)>& w) {
  const auto on = [&](int i) { return w[i] != 0; };
  if constexpr (K == PairKind::point_point) return "p_p";
  if constexpr (K == PairKind::point_edge) return on(1) && on(2) ? "p_e" : on(1) ? "p_e0" : "p_e1";
  if constexpr (K == PairKind::point_triangle) {
    if (on(1) && on(2) && on(3)) return "p_t";
    if (on(1) && on(2)) return "p_e01";
    if (on(2) && on(3)) return "p_e12";
    if (on(3) && on(1)) return "p_e20";
    return on(1) ? "p_t0" : on(2) ? "p_t1" : "p_t2";
  }
  if constexpr (K == PairKind::edge_edge) {
    const std::string a = on(0) && on(1) ? "ea" : on(0) ? "ea0" : "ea1";
    return a + "_" + (on(2) && on(3) ? "eb" : on(2) ? "eb0" : "eb1");
  }
}

/// Coordinates uniform in [-1, 1].
template <int N>
Points<double, N> random_points(std::mt19937& rng) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Points<double, N> x;
  for (int i = 0; i < N; ++i) {
    for (int k = 0; k < 3; ++k) x(k, i) = uniform(rng);
  }
  return x;
}

Mat3d random_rotation(std::mt19937& rng);

}  // namespace bb::test
