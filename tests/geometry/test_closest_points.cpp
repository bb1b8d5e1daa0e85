// Closest points of all kinds of pairs against enumeration in long double: regions, their borders,
// degenerate shapes, invariance.
#include "core/geometry/closest_points.hpp"

#include <gtest/gtest.h>

#include <map>
#include <numbers>

#include "tests/geometry/closest_oracle.hpp"

namespace {

using namespace bb;
using namespace bb::test;

template <PairKind K>
struct Kind {
  static constexpr PairKind value = K;
  static constexpr int n = pair_points(K);
};
template <class K>
class ClosestPoints : public testing::Test {};
using Kinds = testing::Types<Kind<PairKind::point_point>, Kind<PairKind::point_edge>,
                             Kind<PairKind::point_triangle>, Kind<PairKind::edge_edge>>;
TYPED_TEST_SUITE(ClosestPoints, Kinds);

template <PairKind K, class T>
void expect_consistent(const Points<T, pair_points(K)>& x, const Closest<T, pair_points(K)>& c, T tolerance) {
  const T size = x.cwiseAbs().maxCoeff();
  EXPECT_LE((x * c.weights - c.r).norm(), tolerance * size);
  EXPECT_EQ(c.d, c.r.norm());
  EXPECT_NEAR(c.weights.head(pair_split(K)).sum(), T(1), tolerance);
  EXPECT_NEAR(c.weights.tail(pair_points(K) - pair_split(K)).sum(), T(-1), tolerance);
  EXPECT_GE(c.weights.head(pair_split(K)).minCoeff(), T(0));
  EXPECT_LE(c.weights.tail(pair_points(K) - pair_split(K)).maxCoeff(), T(0));
}

template <PairKind K>
void expect_matches_oracle(const Points<double, pair_points(K)>& x, double tolerance) {
  const auto c = closest_points<K, double>(x);
  const auto oracle = oracle_closest<K>(x);
  expect_consistent<K, double>(x, c, 1e-14);
  EXPECT_NEAR(c.d, static_cast<double>(oracle.d), tolerance * x.cwiseAbs().maxCoeff());
}

TYPED_TEST(ClosestPoints, EveryRegionMatchesTheOracle) {
  constexpr PairKind K = TypeParam::value;
  std::mt19937 rng(7);
  std::map<std::string, int> seen;
  for (int k = 0; k < 2500; ++k) {
    const auto x = random_points<TypeParam::n>(rng);
    const auto oracle = oracle_closest<K>(x);
    const auto c = closest_points<K, double>(x);
    expect_consistent<K, double>(x, c, 1e-14);
    EXPECT_NEAR(c.d, static_cast<double>(oracle.d), 1e-13 * static_cast<double>(oracle.d) + 1e-15);
    EXPECT_LE((c.r.template cast<Long>() - oracle.r).norm(), 1e-13L);
    if (oracle.least_weight < 1e-9L) continue;
    EXPECT_EQ(region_name(c.region), region_word<K>(oracle.weights));
    if (oracle.least_weight > 1e-2L && oracle.d > 1e-2L) {
      EXPECT_LE((c.weights.template cast<Long>() - oracle.weights).cwiseAbs().maxCoeff(), 1e-11L);
    }
    ++seen[region_name(c.region)];
  }
  EXPECT_EQ(seen.size(), K == PairKind::point_point      ? 1U
                         : K == PairKind::point_edge     ? 3U
                         : K == PairKind::point_triangle ? 7U
                                                         : 9U);
  for (const auto& [name, count] : seen) EXPECT_GT(count, 20) << name;
}

TYPED_TEST(ClosestPoints, RigidMotionsChangeNothing) {
  constexpr PairKind K = TypeParam::value;
  std::mt19937 rng(11);
  for (int k = 0; k < 200; ++k) {
    const auto x = random_points<TypeParam::n>(rng);
    const Mat3d q = random_rotation(rng);
    const Points<double, TypeParam::n> moved = (q * x).colwise() + Vec3d(0.3, -2, 1);

    const auto a = closest_points<K, double>(x), b = closest_points<K, double>(moved);
    EXPECT_NEAR(a.d, b.d, 1e-14);
    EXPECT_LE((q * a.r - b.r).norm(), 1e-13);
  }
}

TYPED_TEST(ClosestPoints, TranslationWithoutRoundingKeepsEveryBit) {
  constexpr PairKind K = TypeParam::value;
  std::mt19937 rng(13);
  for (int k = 0; k < 200; ++k) {
    Points<double, TypeParam::n> x = random_points<TypeParam::n>(rng);
    x = (x * 0x1p20).array().round().matrix() * 0x1p-20;
    const Points<double, TypeParam::n> far = x.array() + 0x1p25;

    const auto a = closest_points<K, double>(x), b = closest_points<K, double>(far);
    EXPECT_GT(a.d, 0);
    EXPECT_EQ(a.d, b.d);
    EXPECT_EQ(a.weights, b.weights);
    EXPECT_EQ(a.region, b.region);
  }
}

TYPED_TEST(ClosestPoints, FloatMatchesTheOracle) {
  constexpr PairKind K = TypeParam::value;
  std::mt19937 rng(17);
  for (int k = 0; k < 500; ++k) {
    const Points<float, TypeParam::n> x = random_points<TypeParam::n>(rng).template cast<float>();
    const auto c = closest_points<K, float>(x);
    expect_consistent<K, float>(x, c, 1e-6f);
    EXPECT_NEAR(static_cast<double>(c.d), static_cast<double>(oracle_closest<K>(x).d), 1e-6);
  }
}

TEST(PointTriangle, ObtuseApexFrom60To179Degrees) {
  std::mt19937 rng(19);
  std::uniform_real_distribution<double> uniform(-1.5, 1.5);
  for (const int degrees : {60, 90, 120, 150, 170, 179}) {
    const double angle = degrees * std::numbers::pi / 180;
    for (int k = 0; k < 300; ++k) {
      Points<double, 4> x;
      x << uniform(rng), 0, 1, std::cos(angle), uniform(rng), 0, 0, std::sin(angle), uniform(rng) / 4, 0, 0,
          0;
      for (const int first : {1, 2, 3}) {  // the apex at each place
        Points<double, 4> turned = x;
        for (int i = 0; i < 3; ++i) turned.col(1 + i) = x.col(1 + (i + first) % 3);
        expect_matches_oracle<PairKind::point_triangle>(turned, 1e-13);
      }
    }
  }
}

TEST(PointTriangle, BordersOfAllRegions) {
  Points<double, 4> x;
  x << 0, 0, 1, 0.3, 0, 0, 0, 0.8, 0, 0, 0, 0;
  for (const double side : {-1e-12, 0.0, 1e-12}) {
    for (int e = 0; e < 3; ++e) {
      const Vec3d a = x.col(1 + e), b = x.col(1 + (e + 1) % 3), along = (b - a).normalized();
      const Vec3d out(along[1], -along[0], 0);
      for (const double height : {1e-8, 1e-3, 0.5}) {
        const Vec3d up(0, 0, height);
        x.col(0) = 0.4 * a + 0.6 * b + side * out + up;  // interior against edge
        expect_matches_oracle<PairKind::point_triangle>(x, 1e-15);
        x.col(0) = a + side * along + 0.3 * out + up;  // edge against vertex
        expect_matches_oracle<PairKind::point_triangle>(x, 1e-15);
        x.col(0) = a + side * along + side * out + up;
        expect_matches_oracle<PairKind::point_triangle>(x, 1e-15);
      }
    }
  }
}

TEST(PointEdge, BordersOfAllRegions) {
  Points<double, 3> x;
  for (const double side : {-1e-12, 0.0, 1e-12}) {
    for (const double at : {0.0, 1.0}) {
      x << at + side, 0, 1, 0.25, 0, 0, 0, 0, 0;
      expect_matches_oracle<PairKind::point_edge>(x, 1e-16);
      const Region clamped = at == 0.0 ? Region::p_e0 : Region::p_e1;
      EXPECT_EQ(closest_point_edge(x).region, (at == 0.0) == (side > 0) && side != 0 ? Region::p_e : clamped);
    }
  }
}

TEST(EdgeEdge, BordersOfAllRegions) {
  Points<double, 4> x;
  for (const double sa : {0.0, 0.5, 1.0}) {
    for (const double sb : {0.0, 0.5, 1.0}) {
      for (const double side : {-1e-12, 0.0, 1e-12}) {
        // a along x with its point sa at side, b along (1, 2) with its point sb at 0, 0.1 above
        x << -sa + side, 1 - sa + side, -sb, 1 - sb, 0, 0, -2 * sb, 2 - 2 * sb, 0.1, 0.1, 0, 0;
        expect_matches_oracle<PairKind::edge_edge>(x, 1e-15);
      }
    }
  }
}

TEST(PointTriangle, ThinAndZeroAreaTriangles) {
  std::mt19937 rng(23);
  for (const double thin : {1e-3, 1e-6, 1e-9, 1e-12, 1e-15, 0.0}) {
    for (int k = 0; k < 200; ++k) {
      Points<double, 4> x = random_points<4>(rng);
      const Vec3d aside = x.col(3);
      x.col(3) = 0.7 * x.col(1) + 0.3 * x.col(2) + thin * aside;
      expect_matches_oracle<PairKind::point_triangle>(x, 1e-14);
    }
  }
  Points<double, 4> point = random_points<4>(rng);
  point.col(2) = point.col(3) = point.col(1);
  expect_matches_oracle<PairKind::point_triangle>(point, 1e-15);
}

TEST(EdgeEdge, ParallelNearParallelAndZeroLength) {
  std::mt19937 rng(29);
  for (const double turn : {1e-3, 1e-6, 1e-8, 1e-10, 1e-12, 1e-15, 0.0}) {
    for (int k = 0; k < 200; ++k) {
      Points<double, 4> x = random_points<4>(rng);
      const Vec3d aside = x.col(3);
      x.col(2) = x.col(0) + 0.1 * (x.col(2) - x.col(0)) + 0.2 * (x.col(1) - x.col(0));
      x.col(3) = x.col(2) + 0.8 * (x.col(1) - x.col(0)) + turn * aside;
      expect_matches_oracle<PairKind::edge_edge>(x, 1e-14);
    }
  }
  Points<double, 4> x = random_points<4>(rng);
  x.col(1) = x.col(0);
  expect_matches_oracle<PairKind::edge_edge>(x, 1e-15);
  x.col(3) = x.col(2);
  expect_matches_oracle<PairKind::edge_edge>(x, 1e-15);
}

// The direction of a tiny gap is what a step bound lives on: it keeps its digits.
TEST(PointEdge, DirectionOfATinyGap) {
  std::mt19937 rng(31);
  for (const double gap : {1e-4, 1e-8, 1e-12}) {
    for (int k = 0; k < 100; ++k) {
      Points<double, 3> x = random_points<3>(rng);
      const Vec3d u = x.col(2) - x.col(1);
      x.col(0) = x.col(1) + 0.37 * u + gap * u.cross(Vec3d(x.col(0))).normalized();
      const auto c = closest_point_edge(x);
      ASSERT_EQ(c.region, Region::p_e);
      EXPECT_LE(std::abs(c.r.dot(u)) / (c.d * u.norm()), 2e-15);
    }
  }
}

TEST(Region, NamesAreTheContractsWords) {
  EXPECT_STREQ(region_name(Region::p_p), "p_p");
  EXPECT_STREQ(region_name(Region::p_e20), "p_e20");
  EXPECT_STREQ(region_name(Region::p_t), "p_t");
  EXPECT_STREQ(region_name(Region::ea1_eb0), "ea1_eb0");
  EXPECT_STREQ(region_name(Region::ea_eb), "ea_eb");
}

}  // namespace
