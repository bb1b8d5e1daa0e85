// The cheap tests of one pair against what they stand in for: the closest points and ACCD.
#include <gtest/gtest.h>

#include <random>

#include "core/contact/pair_motion.hpp"

namespace bb {
namespace {

/// Random pairs of all shapes: primitives of any size, at any distance, some of them flat, far
/// from the origin.
class Pairs {
 public:
  template <PairKind K>
  Mat<double, 3, pair_points(K)> next() {
    Mat<double, 3, pair_points(K)> x;
    const double size = power(3), away = power(3);
    for (int k = 0; k < pair_points(K); ++k) x.col(k) = size * point();
    x.leftCols(pair_split(K)).colwise() += Vec3d(away * point());
    if (rng_() % 3 == 0) x.row(2) *= 1e-6;
    x.colwise() += Vec3d(power(4) * point());
    return x;
  }
  /// A common displacement and a part of each point's own.
  template <int N>
  Mat<double, 3, N> moved(const Mat<double, 3, N>& x) {
    Mat<double, 3, N> out = x;
    const double own = power(6);
    for (int k = 0; k < N; ++k) out.col(k) += own * point();
    out.colwise() += Vec3d(power(3) * point());
    return out;
  }
  double power(double decades) { return std::pow(10.0, decades * unit_(rng_)) / 10; }

 private:
  Vec3d point() { return {unit_(rng_), unit_(rng_), unit_(rng_)}; }
  std::mt19937_64 rng_{1};
  std::uniform_real_distribution<double> unit_{-1, 1};
};

template <PairKind K>
void expect_no_false_claim() {
  Pairs pairs;
  int clear = 0, claimed = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto x = pairs.next<K>();
    const double d = closest_points<K, double>(x).d;
    for (const double share : {0.0, 0.3, 0.7, 1 - 1e-9, 1.0, 1 + 1e-15}) {
      const bool far = farther_than<K>(x, share * d);
      if (share >= 1) {
        EXPECT_FALSE(far) << i << " at " << share;
      } else if (share == 0.3) {
        ++clear;
        claimed += far ? 1 : 0;
      }
    }
  }
  EXPECT_GT(claimed, 9 * clear / 10);
}

TEST(FartherThan, NeverClaimsMoreThanTheDistanceAndSettlesClearPairs) {
  expect_no_false_claim<PairKind::point_point>();
  expect_no_false_claim<PairKind::point_edge>();
  expect_no_false_claim<PairKind::point_triangle>();
  expect_no_false_claim<PairKind::edge_edge>();
}

TEST(FartherThan, ClaimsNothingOfPairsThatTouchOrAreNotFinite) {
  Mat<double, 3, 4> x = Mat<double, 3, 4>::Zero();
  EXPECT_FALSE(farther_than<PairKind::edge_edge>(x, 0));
  x.col(1) << 1, 0, 0;
  x.col(2) << 0.5, -1, 0;
  x.col(3) << 0.5, 1, 0;
  EXPECT_FALSE(farther_than<PairKind::edge_edge>(x, 0));
  x(2, 0) = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(farther_than<PairKind::edge_edge>(x, 0));
}

template <PairKind K>
void expect_what_accd_returns() {
  Pairs pairs;
  int settled = 0, skipped = 0, hits = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto x0 = pairs.next<K>();
    const auto x1 = pairs.moved(x0);
    const double offset = i % 3 == 0 ? 1e-3 : 0, park = i % 2 == 0 ? 1e-8 : 0;
    const AccdResult<double> expected = accd<K, double>(x0, x1, offset, park, 64);
    const AccdResult<double> result = pair_toi<K>(x0, x1, offset, park, 64);
    ASSERT_EQ(result.toi, expected.toi) << i;
    ASSERT_EQ(result.hit, expected.hit) << i;
    ASSERT_EQ(result.probes, expected.probes) << i;
    ASSERT_EQ(result.capped, expected.capped) << i;
    ASSERT_EQ(result.overlap_at_start, expected.overlap_at_start) << i;
    hits += expected.hit ? 1 : 0;
    settled += !expected.hit && expected.probes == 1 ? 1 : 0;
    // without a probe to spend accd() proves nothing; the one in the result is then that of the certificate
    skipped += pair_toi<K>(x0, x1, offset, park, 0).probes == 1 ? 1 : 0;
  }
  EXPECT_GT(hits, 100);
  EXPECT_GT(settled, 1000);
  EXPECT_GT(skipped, settled / 2);
}

TEST(PairToi, IsWhatAccdReturnsProbesIncluded) {
  expect_what_accd_returns<PairKind::point_point>();
  expect_what_accd_returns<PairKind::point_edge>();
  expect_what_accd_returns<PairKind::point_triangle>();
  expect_what_accd_returns<PairKind::edge_edge>();
}

}  // namespace
}  // namespace bb
