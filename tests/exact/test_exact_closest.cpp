// Closest points in double and float against exact integers, over families of hard pairs. BARRIERBENCH_EXACT_PAIRS sets the
// number of pairs of a run (20,000 by default; 1,000,000 for the table of results/fuzz.md).
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "core/geometry/closest_points.hpp"
#include "tests/exact/exact_closest.hpp"
#include "tests/exact/hard_pairs.hpp"

namespace bb::test::exact_closest_test {
namespace {

/// In ulps: eps of the precision times the largest difference of coordinates in the pair.
struct Errors {
  std::vector<double> d;  // |d - exact|
  std::vector<double> r;  // | |r| as returned - |sum w_i (x_i - x_0)| | of the returned weights
  std::vector<double>
      witness;  // |sum w_i (x_i - x_0)| - exact: what the returned points are farther apart than need be
  std::vector<double> region;  // the same of the best points of the returned region
  double worst_ratio = 0;      // largest |d/exact - 1|, where exact is at least 1e-3 of the size
  int active = 0;              // pairs with d > 0
};

long total_pairs() {
  const char* text = std::getenv("BARRIERBENCH_EXACT_PAIRS");
  return text ? std::max(1000L, std::strtol(text, nullptr, 10)) : 20000;
}

template <PairKind K>
double size_of(const Mat<double, 3, 4>& x) {
  constexpr int n = pair_points(K);
  const auto points = x.leftCols<n>();
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).maxCoeff();
}

template <PairKind K, class T>
void judge(const Mat<double, 3, 4>& x, Errors& errors) {
  constexpr int n = pair_points(K);
  const Mat<T, 3, n> points = x.leftCols<n>().template cast<T>();
  const Closest<T, n> closest = closest_points<K, T>(points);
  ASSERT_TRUE(std::isfinite(closest.d));
  ASSERT_LE(static_cast<double>(closest.d), 2 * size_of<K>(x));
  const ExactPair pair = exact_pair(x.leftCols<n>(), pair_split(K));
  const ExactDistance exact = exact_distance(pair);
  const double unit = std::numeric_limits<T>::epsilon() * size_of<K>(x), d = static_cast<double>(closest.d);
  std::vector<double> weights;
  for (int i = 0; i < n; ++i) weights.push_back(static_cast<double>(closest.weights[i]));
  const ExactDistance realised = exact_combination(pair, weights);
  errors.d.push_back(std::abs(error_in(unit, d, exact, pair.exponent)));
  errors.r.push_back(std::abs(error_in(unit, d, realised, pair.exponent)));
  errors.witness.push_back(excess_in(unit, realised, exact, pair.exponent));
  errors.region.push_back(
      excess_in(unit, exact_distance(pair, region_points(closest.region)), exact, pair.exponent));
  errors.active += closest.d > 0;
  const double of_size = error_in(0, d, exact, pair.exponent);
  if (d > 1e-3 * size_of<K>(x)) errors.worst_ratio = std::max(errors.worst_ratio, std::abs(of_size) / d);
}

double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
}

double largest(const std::vector<double>& values) { return *std::max_element(values.begin(), values.end()); }

template <PairKind K, class T>
Errors judge_family(Family family, long pairs) {
  std::mt19937_64 random(static_cast<std::uint64_t>(family) * 100 + static_cast<std::uint64_t>(K) * 10 +
                         sizeof(T));
  Errors out;
  for (long k = 0; k < pairs; ++k) judge<K, T>(hard_pair(family, K, sizeof(T) == 4, random), out);
  return out;
}

void print_head() {
  std::printf("%-15s %-7s %-10s %8s | %8s %8s | %8s %8s %8s | %9s\n", "pair", "", "family", "pairs",
              "d 99.9%", "d max", "r max", "witness", "region", "|d/d0-1|");
}

void print_row(const char* pair, const char* precision, Family family, const Errors& e) {
  std::printf("%-15s %-7s %-10s %8zu | %8.2g %8.2g | %8.2g %8.2g %8.2g | %9.2g\n", pair, precision,
              family_name(family), e.d.size(), quantile(e.d, 0.999), largest(e.d), largest(e.r),
              largest(e.witness), largest(e.region), e.worst_ratio);
}

/// Ulps of the pair's size. The largest of 10^6 pairs in each precision are 2.7 and 1.7 (results/fuzz.md).
constexpr double most_d = 4, most_witness = 4;

template <PairKind K, class T>
void judge_kind(const char* precision) {
  const long each = total_pairs() / (3 * n_families);
  print_head();
  for (int f = 0; f < n_families; ++f) {
    const auto family = static_cast<Family>(f);
    const Errors errors = judge_family<K, T>(family, each);
    ASSERT_EQ(errors.d.size(), static_cast<std::size_t>(each));
    print_row(pair_name(K), precision, family, errors);
    if (family == Family::denormal)
      continue;  // out of range: only finite and no larger than the pair, see judge
    EXPECT_GT(errors.active, each / 4) << family_name(family);
    EXPECT_LE(largest(errors.d), most_d) << family_name(family);
    EXPECT_LE(largest(errors.witness), most_witness) << family_name(family);
    EXPECT_LE(largest(errors.region), most_witness) << family_name(family);
  }
}

TEST(ExactClosest, PointEdgeDouble) { judge_kind<PairKind::point_edge, double>("double"); }
TEST(ExactClosest, PointEdgeFloat) { judge_kind<PairKind::point_edge, float>("float"); }
TEST(ExactClosest, PointTriangleDouble) { judge_kind<PairKind::point_triangle, double>("double"); }
TEST(ExactClosest, PointTriangleFloat) { judge_kind<PairKind::point_triangle, float>("float"); }
TEST(ExactClosest, EdgeEdgeDouble) { judge_kind<PairKind::edge_edge, double>("double"); }
TEST(ExactClosest, EdgeEdgeFloat) { judge_kind<PairKind::edge_edge, float>("float"); }

}  // namespace
}  // namespace bb::test::exact_closest_test
