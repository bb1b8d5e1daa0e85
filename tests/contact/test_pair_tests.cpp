// The cheap tests of one pair against what they stand in for: the closest points and ACCD.
#include <gtest/gtest.h>

#include <random>

#include "core/contact/motion_box.hpp"
#include "core/contact/obstacle_motion.hpp"
#include "core/contact/pair_lanes.hpp"
#include "core/geometry/accd.hpp"

namespace bb::pair_tests_test {
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

/// N points as the only vertices of a scene, pair by pair: what the tests of four pairs read.
template <PairKind K>
struct FourPairs {
  static constexpr int n = pair_points(K);
  Positions x0{3, 4 * n}, x1{3, 4 * n};
  std::array<ContactPair<K>, n_lanes> pair;

  void set(std::size_t lane, const Mat<double, 3, n>& at0, const Mat<double, 3, n>& at1) {
    for (int k = 0; k < n; ++k) pair[lane].vertex[static_cast<std::size_t>(k)] = first(lane) + k;
    x0.template middleCols<n>(first(lane)) = at0;
    x1.template middleCols<n>(first(lane)) = at1;
  }
  Mat<double, 3, n> at0(std::size_t lane) const { return x0.template middleCols<n>(first(lane)); }
  Mat<double, 3, n> at1(std::size_t lane) const { return x1.template middleCols<n>(first(lane)); }
  static int first(std::size_t lane) { return n * static_cast<int>(lane); }
};

template <PairKind K>
MotionBox box_of(const Mat<double, 3, pair_points(K)>& x0, const Mat<double, 3, pair_points(K)>& x1,
                 int begin, int end, double reach) {
  std::vector<int> corners;
  for (int k = begin; k < end; ++k) corners.push_back(k);
  return motion_box(corners, reach, Positions(x0), Positions(x1));
}

/// Neither boxes nor planes prove a pair apart beyond the time at which ACCD stops it, and planes settle most
/// of the pairs that nothing stops.
template <PairKind K>
void expect_no_time_later_than_accd() {
  constexpr int n = pair_points(K), split = pair_split(K);
  Pairs pairs;
  FourPairs<K> four;
  int hits = 0, late = 0, free = 0, settled = 0, boxed = 0, cleared = 0;
  for (int i = 0; i < 8000; ++i) {
    const double offset = i % 3 == 0 ? 1e-3 : 0, park = i % 2 == 0 ? 1e-8 : 0;
    Lanes4 reach;
    for (std::size_t lane = 0; lane < n_lanes; ++lane) {
      const auto x0 = pairs.next<K>();
      four.set(lane, x0, pairs.moved(x0));
      const double largest = std::max(x0.cwiseAbs().maxCoeff(), four.at1(lane).cwiseAbs().maxCoeff());
      reach.v[lane] = offset + 2 * std::max(park, 2 * ulp_floor(largest));
    }
    const PairLanes<K, Lanes4> points = gather_lanes<K>(four.pair, four.x0);
    const PairLanes<K, Lanes4> motion = gather_lanes<K>(four.pair, four.x1) - points;
    const Lanes4 proven = proven_times<K>(points, motion, reach, 1);
    const Lanes4 axes = proven_times_by_axes<K>(points, motion, reach);
    for (std::size_t lane = 0; lane < n_lanes; ++lane) {
      const auto x0 = four.at0(lane), x1 = four.at1(lane);
      const auto r = accd<K, double>(x0, x1, offset, park);
      const double by_planes = proven[static_cast<int>(lane)], half = reach.v[lane] / 2;
      const double by_axes = axes[static_cast<int>(lane)];
      const double by_boxes =
          proven_time(box_of<K>(x0, x1, 0, split, half), box_of<K>(x0, x1, split, n, half));
      if (r.hit && !r.capped) {
        ++hits;
        late += by_planes > 0.5 * r.toi ? 1 : 0;
        boxed += by_boxes > 0 ? 1 : 0;
        EXPECT_LE(by_planes, r.toi) << i;
        EXPECT_LE(by_boxes, r.toi) << i;
        EXPECT_LE(by_axes, r.toi) << i;
        EXPECT_GE(by_axes, 0.999 * by_boxes - 1e-5) << i;  // the boxes of motions, in double
        cleared += by_axes > 0 ? 1 : 0;
      } else if (!r.hit) {
        ++free;
        settled += by_planes > 1 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(hits, 200);
  EXPECT_GT(late, hits / 15);
  EXPECT_GT(boxed, hits / 20);
  EXPECT_GT(cleared, hits / 20);
  EXPECT_GT(settled, 2 * free / 3);
}

TEST(ProvenTimes, AreNeverLaterThanAccdAndSettleMostFreePairs) {
  expect_no_time_later_than_accd<PairKind::point_point>();
  expect_no_time_later_than_accd<PairKind::point_edge>();
  expect_no_time_later_than_accd<PairKind::point_triangle>();
  expect_no_time_later_than_accd<PairKind::edge_edge>();
}

TEST(ProvenTimes, OfBoxesThatAreNotFiniteAreNothing) {
  Positions x0 = Positions::Zero(3, 2), x1 = x0;
  x0(0, 1) = 1;
  x1(0, 1) = 0.25;
  const auto time = [&] {
    return proven_time(motion_box(std::array{0}, 0.0, x0, x1), motion_box(std::array{1}, 0.0, x0, x1));
  };
  EXPECT_NEAR(time(), 4.0 / 3, 1e-5);
  x1(0, 1) = -1e300;
  EXPECT_EQ(time(), 0);
  x0(0, 0) = x0(0, 1) = x1(0, 0) = x1(0, 1) = 1e300;
  EXPECT_EQ(time(), 0);
}

/// Given up, a query returns what it had proven; not given up, it is the query that goes to the end.
template <PairKind K>
void expect_give_up() {
  Pairs pairs;
  int given_up = 0, ended = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto x0 = pairs.next<K>();
    const auto x1 = pairs.moved(x0);
    const AccdResult<double> whole = accd<K, double>(x0, x1, 0.0, 1e-8);
    const double enough = 0.4;
    const AccdResult<double> part = accd<K, double>(x0, x1, 0.0, 1e-8, 4096, enough);
    ASSERT_LE(part.probes, whole.probes);
    if (part.toi == whole.toi && part.hit == whole.hit) {
      ++ended;
      continue;
    }
    ++given_up;
    ASSERT_FALSE(part.hit);
    ASSERT_GT(part.toi, enough);
    ASSERT_LE(part.toi, whole.toi);
  }
  EXPECT_GT(given_up, 100);
  EXPECT_GT(ended, 100);
}

TEST(Accd, GivesUpAPairOnlyWhenItIsProvenPastEnough) {
  expect_give_up<PairKind::point_triangle>();
  expect_give_up<PairKind::edge_edge>();
}

}  // namespace
}  // namespace bb::pair_tests_test
