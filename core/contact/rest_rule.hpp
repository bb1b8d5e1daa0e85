// Which pairs of one body are no candidates because they are close at rest (activation_distance in row_rule.hpp): one arithmetic
// for the CPU and for kernels, so that the lists of candidates of both are equal.
#pragma once

#include <limits>

#include "core/contact/pair_geometry.hpp"

namespace bb {

namespace detail {

/// The largest |a_i - b_j|^2 of a vertex of the first and one of the second primitive, or the least, m^2.
template <PairKind K>
BB_HD double most_apart_sq(const Mat<double, 3, pair_points(K)>& x) {
  double out = 0;
  for (int i = 0; i < pair_split(K); ++i) {
    for (int j = pair_split(K); j < pair_points(K); ++j) {
      const double sq = (x.col(i) - x.col(j)).squaredNorm();
      out = sq > out ? sq : out;
    }
  }
  return out;
}
template <PairKind K>
BB_HD double least_apart_sq(const Mat<double, 3, pair_points(K)>& x) {
  double out = std::numeric_limits<double>::infinity();
  for (int i = 0; i < pair_split(K); ++i) {
    for (int j = pair_split(K); j < pair_points(K); ++j) {
      const double sq = (x.col(i) - x.col(j)).squaredNorm();
      out = sq < out ? sq : out;
    }
  }
  return out;
}

}  // namespace detail

/// Whether a pair of one body, which the rest rule gives a smaller d_hat (activation_distance), is proven to stay farther apart
/// than that on x0 -> x1, and farther than any level at which ACCD may stop it, which is largest_min_gap_fraction d_hat or some ulps. Such a
/// pair has no row and does not bound the motion. false where the rule does not act, or nothing is proven.
/// @param eps of the scalar in which distances are evaluated
/// @param together whether all vertices are the same part of the motion on their way; else each is at its own
template <PairKind K>
BB_HD bool apart_by_rest_rule(const Side& law, const Mat<double, 3, pair_points(K)>& rest,
                              const Mat<double, 3, pair_points(K)>& x0,
                              const Mat<double, 3, pair_points(K)>& x1, double eps, bool together = true) {
  using std::sqrt;
  const double acts_below = law.offset + rest_rule_factor * law.d_hat,
               rest_sq = detail::least_apart_sq<K>(rest);
  if (!(rest_sq < acts_below * acts_below)) return false;
  // the distance at rest is no more than that of the nearest vertices; with a gap of 0 the rule does not act
  const double row = (sqrt(rest_sq) - law.offset) / rest_rule_factor,
               stop = 2.5 * largest_min_gap_fraction * law.d_hat;
  const double moved = together ? sqrt(detail::most_apart_sq<K>(x1 - x0)) / 2
                                : sqrt((x1 - x0).colwise().squaredNorm().maxCoeff());
  const double first = x0.cwiseAbs().maxCoeff(), last = x1.cwiseAbs().maxCoeff();
  const double rounding = 64 * eps * ((first > last ? first : last) + law.offset);
  const double reach = law.offset + (row > stop ? row : stop) + moved + rounding;
  return farther_than<K>((x0 + x1) / 2, reach) && farther_than<K>(rest, law.offset);
}

}  // namespace bb
