// Closest points by enumeration in long double: every pair of faces of the two simplices is solved by dense
// linear algebra, the best feasible one wins. Shares no formula with core/geometry.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
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

/// Minimises |sum w x| over one face of each primitive (bit i of `faces`: point i takes part) and keeps it if
/// better.
template <int N>
void try_faces(const Points<Long, N>& x, int split, unsigned faces, OracleClosest<N>& best) {
  int first = -1, second = -1, n = 0;
  Eigen::Matrix<Long, 3, Eigen::Dynamic> directions(3, N);
  std::array<int, N> moved{}, base{};
  for (int i = 0; i < N; ++i) {
    if ((faces >> i & 1U) == 0) continue;
    int& origin = i < split ? first : second;
    if (origin < 0) {
      origin = i;
      continue;
    }
    moved[static_cast<std::size_t>(n)] = i;
    base[static_cast<std::size_t>(n)] = origin;
    directions.col(n++) = (x.col(i) - x.col(origin)) * (i < split ? 1 : -1);
  }
  if (first < 0 || second < 0) return;
  OracleClosest<N> candidate;
  candidate.weights[first] = 1;
  candidate.weights[second] = -1;
  const Vec<Long, 3> r0 = x.col(first) - x.col(second);
  if (n > 0) {
    const Eigen::Matrix<Long, Eigen::Dynamic, 1> s = directions.leftCols(n).colPivHouseholderQr().solve(-r0);
    for (int k = 0; k < n; ++k) {
      const int i = moved[static_cast<std::size_t>(k)], origin = base[static_cast<std::size_t>(k)];
      const Long sign = i < split ? 1 : -1;
      candidate.weights[i] += sign * s[k];
      candidate.weights[origin] -= sign * s[k];
    }
  }
  candidate.least_weight = 1;
  for (int i = 0; i < N; ++i) {
    if ((faces >> i & 1U) == 0) continue;
    candidate.least_weight = std::min(candidate.least_weight, candidate.weights[i] * (i < split ? 1 : -1));
  }
  if (!(candidate.least_weight >= 0)) return;
  candidate.r = r0;
  for (int k = 0; k < n; ++k) {
    const int i = moved[static_cast<std::size_t>(k)];
    candidate.r += directions.col(k) * candidate.weights[i] * (i < split ? 1 : -1);
  }
  candidate.d = candidate.r.norm();
  if (candidate.d < best.d) best = candidate;
}

template <PairKind K, class T>
OracleClosest<pair_points(K)> oracle_closest(const Points<T, pair_points(K)>& x) {
  constexpr int N = pair_points(K);
  OracleClosest<N> best;
  for (unsigned faces = 1; faces < (1U << N); ++faces) {
    try_faces<N>(x.template cast<Long>(), pair_split(K), faces, best);
  }
  return best;
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

inline Mat3d random_rotation(std::mt19937& rng) {
  const Points<double, 3> x = random_points<3>(rng);
  Mat3d q = Eigen::HouseholderQR<Mat3d>(x).householderQ();
  if (q.determinant() < 0) q.col(0) *= -1;
  return q;
}

}  // namespace bb::test
