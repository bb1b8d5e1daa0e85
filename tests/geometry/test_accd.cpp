// ACCD of one pair: analytic times, cheap sliding, starts at the floor, and proofs re-checked in long double.
#include "core/geometry/accd.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/geometry/closest_oracle.hpp"

namespace {

using namespace bb;
using namespace bb::test;

template <PairKind K, class T>
struct Case {
  static constexpr PairKind kind = K;
  static constexpr int n = pair_points(K);
  using Scalar = T;
};
template <class C>
class Accd : public testing::Test {};
using Cases = testing::Types<Case<PairKind::point_point, double>, Case<PairKind::point_edge, double>,
                             Case<PairKind::point_triangle, double>, Case<PairKind::edge_edge, double>,
                             Case<PairKind::point_point, float>, Case<PairKind::point_edge, float>,
                             Case<PairKind::point_triangle, float>, Case<PairKind::edge_edge, float>>;
TYPED_TEST_SUITE(Accd, Cases);

/// First primitive `gap` above the second, both through the z axis in their interiors.
template <PairKind K, class T>
Points<T, pair_points(K)> stacked(T gap) {
  Points<T, pair_points(K)> x;
  if constexpr (K == PairKind::point_point) x << 0, 0, 0, 0, gap, 0;
  if constexpr (K == PairKind::point_edge) x << 0, -1, 1, 0, 0, 0, gap, 0, 0;
  if constexpr (K == PairKind::point_triangle) x << 0, -1, 1, 0, 0, -1, -1, 1, gap, 0, 0, 0;
  if constexpr (K == PairKind::edge_edge) x << -1, 1, 0, 0, 0, 0, -1, 1, gap, gap, 0, 0;
  return x;
}

template <PairKind K, class T>
Points<T, pair_points(K)> first_moved(Points<T, pair_points(K)> x, const Vec<T, 3>& by) {
  x.leftCols(pair_split(K)).colwise() += by;
  return x;
}

/// Gap of the exact motion at time t.
template <PairKind K, class T>
Long exact_gap(const Points<T, pair_points(K)>& x0, const Points<T, pair_points(K)>& x1, Long t) {
  const auto a = x0.template cast<Long>(), b = x1.template cast<Long>();
  return oracle_closest<K>(Points<Long, pair_points(K)>(a + t * (b - a))).d;
}

/// A motion that is NaN, or whose square overflows, is treated as bound 0: every input in turn.
TYPED_TEST(Accd, WhatIsNotFiniteIsNeverFree) {
  constexpr PairKind K = TypeParam::kind;
  using T = typename TypeParam::Scalar;
  const auto x0 = stacked<K, T>(T(0.5)), x1 = first_moved<K, T>(x0, Vec<T, 3>(3, 0, 0));
  ASSERT_FALSE((accd<K, T>(x0, x1, T(0.125), T(1e-3)).hit));  // free as it stands
  constexpr T nan = std::numeric_limits<T>::quiet_NaN(), inf = std::numeric_limits<T>::infinity();
  const T huge = std::sqrt(std::numeric_limits<T>::max()) * 2;
  int asked = 0;
  const auto stops = [&asked](const AccdResult<T>& r) {
    EXPECT_TRUE(r.hit);
    EXPECT_EQ(r.toi, 0);
    ++asked;
  };
  for (const T bad : {nan, -nan, inf, -inf, huge}) {
    for (int i = 0; i < 3 * pair_points(K); ++i) {
      auto start = x0, end = x1;
      start.data()[i] = end.data()[i] = bad;
      SCOPED_TRACE(testing::Message() << i << " is " << bad);
      stops(accd<K, T>(start, x1, T(0.125), T(1e-3)));
      stops(accd<K, T>(x0, end, T(0.125), T(1e-3)));
    }
    if (bad != -inf && bad != huge) stops(accd<K, T>(x0, x1, bad, T(1e-3)));
    if (bad != bad) stops(accd<K, T>(x0, x1, T(0.125), bad));
  }
  EXPECT_GT(asked, 30);
}

/// A direction that is NaN, as that of two parallel edges with rounding to zero, proves nothing.
TYPED_TEST(Accd, ATurnOrADirectionThatIsNotFiniteProvesNothing) {
  constexpr PairKind K = TypeParam::kind;
  using T = typename TypeParam::Scalar;
  const auto x = stacked<K, T>(T(0.5));
  Points<T, pair_points(K)> dx = first_moved<K, T>(x, Vec<T, 3>(3, 0, 0)) - x;
  const Vec<T, 3> n(0, 0, 1), still = Vec<T, 3>::Zero();
  ASSERT_GT((detail::directional_advance<K, T>(x, dx, n, still, T(0.1))), 1);
  constexpr T inf = std::numeric_limits<T>::infinity();
  for (const T bad : {std::numeric_limits<T>::quiet_NaN(), inf, -inf}) {
    for (int i = 0; i < 3; ++i) {
      Vec<T, 3> turn = still, direction = n;
      turn[i] = direction[i] = bad;
      EXPECT_EQ((detail::directional_advance<K, T>(x, dx, n, turn, T(0.1))), 0);
      EXPECT_EQ((detail::directional_advance<K, T>(x, dx, direction, still, T(0.1))), 0);
    }
  }
}

/// The first root against a scan, and NaN or a number whose square overflows in each place.
TEST(FirstRoot, IsNeverLaterThanTheRoot) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(),
                   inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(detail::first_root(1.0, 0.0, 0.0), inf);
  EXPECT_EQ(detail::first_root(1.0, -1.0, 1.0), inf);
  EXPECT_NEAR(detail::first_root(1.0, -2.0, 0.75), 2.0 / 3, 1e-14);
  EXPECT_NEAR(detail::first_root(1.0, 1.0, -2.0), 1, 1e-14);
  for (const double bad : {nan, -inf}) {
    EXPECT_EQ(detail::first_root(1.0, bad, 0.0), 0);
    EXPECT_EQ(detail::first_root(1.0, -1.0, bad), 0);
    EXPECT_EQ(detail::first_root(1.0, 1.0, bad), 0);
  }
  EXPECT_EQ(detail::first_root(nan, -1.0, 0.0), 0);
  EXPECT_EQ(detail::first_root(1.0, 1e200, -1e200), 0);  // the root is 1, its squares are beyond every number
  EXPECT_LE(detail::first_root(1.0, -1e200, 1.0), 1e-200);
}

TYPED_TEST(Accd, HeadOnStopsAtThePark) {
  constexpr PairKind K = TypeParam::kind;
  using T = typename TypeParam::Scalar;
  const auto x0 = stacked<K, T>(T(0.5));
  const auto x1 = first_moved<K, T>(x0, Vec<T, 3>(0, 0, -2));
  for (const T park : {T(0), T(1e-3)}) {
    for (const T offset : {T(0), T(0.125)}) {
      const auto out = accd<K, T>(x0, x1, offset, park);
      EXPECT_TRUE(out.hit);
      EXPECT_FALSE(out.capped || out.overlap_at_start);
      const T tolerance = std::is_same_v<T, double> ? T(1e-14) : T(1e-5);
      EXPECT_NEAR(out.toi, (T(0.5) - offset - park) / 2, tolerance);
      EXPECT_LE(out.probes, 3);
    }
  }
}

TYPED_TEST(Accd, EndingCloserThanTheParkIsAHit) {
  constexpr PairKind K = TypeParam::kind;
  using T = typename TypeParam::Scalar;
  const auto x0 = stacked<K, T>(T(0.5));
  const auto x1 = first_moved<K, T>(x0, Vec<T, 3>(0, 0, T(-0.4995)));

  const auto stopped = accd<K, T>(x0, x1, T(0), T(1e-3));
  EXPECT_TRUE(stopped.hit);
  EXPECT_NEAR(stopped.toi, T(0.499 / 0.4995), T(1e-5));
  const auto free = accd<K, T>(x0, x1, T(0), T(1e-4));
  EXPECT_FALSE(free.hit);
  EXPECT_EQ(free.toi, T(1));
}

TYPED_TEST(Accd, SlidingPairsAreCheap) {
  constexpr PairKind K = TypeParam::kind;
  using T = typename TypeParam::Scalar;
  const T gap = std::is_same_v<T, double> ? T(1e-9) : T(1e-4);
  const auto x0 = stacked<K, T>(gap);
  const auto out = accd<K, T>(x0, first_moved<K, T>(x0, Vec<T, 3>(T(0.4), T(0.2), 0)), T(0), T(0));
  EXPECT_FALSE(out.hit);
  EXPECT_EQ(out.toi, T(1));
  EXPECT_LE(out.probes, 3);
}

TYPED_TEST(Accd, NoRelativeMotionIsFree) {
  constexpr PairKind K = TypeParam::kind;
  using T = typename TypeParam::Scalar;
  const auto x0 = stacked<K, T>(T(0.0625));
  for (const T shift : {T(0), T(64)}) {
    const auto out = accd<K, T>(x0, Points<T, TypeParam::n>(x0.array() + shift), T(0), T(1e-3));
    EXPECT_FALSE(out.hit);
    EXPECT_EQ(out.toi, T(1));
    EXPECT_EQ(out.probes, 1);
  }
}

TYPED_TEST(Accd, StartsAtTheFloor) {
  constexpr PairKind K = TypeParam::kind;
  using T = typename TypeParam::Scalar;
  const T eps = std::numeric_limits<T>::epsilon();
  const Vec<T, 3> down(0, 0, T(-0.5));
  const auto run = [&](T gap, T offset, T park) {
    const auto x0 = stacked<K, T>(gap);
    return accd<K, T>(x0, first_moved<K, T>(x0, down), offset, park);
  };
  // Overlap, and a gap that rounding could have made.
  for (const T gap : {T(0), T(0.0625)}) {
    const auto out = run(gap, gap, T(0));
    EXPECT_TRUE(out.hit && out.overlap_at_start);
    EXPECT_EQ(out.toi, T(0));
  }
  const auto below = run(4 * eps, T(0), T(0));
  EXPECT_TRUE(below.hit);
  EXPECT_EQ(below.toi, T(0));
  EXPECT_EQ(below.overlap_at_start, false);
  // Below twice the park: to half of the gap, never to a halt.
  const auto inside = run(T(1e-3), T(0), T(1e-2));
  EXPECT_TRUE(inside.hit);
  EXPECT_NEAR(inside.toi, T(1e-3), T(1e-5));
  const auto just_above = run(32 * eps, T(0), T(0));
  EXPECT_TRUE(just_above.hit);
  EXPECT_GT(just_above.toi, T(0));
  // Not a number is never free.
  Points<T, TypeParam::n> bad = stacked<K, T>(T(1));
  bad(0, 0) = std::numeric_limits<T>::quiet_NaN();
  EXPECT_TRUE((accd<K, T>(stacked<K, T>(T(1)), bad, T(0), T(0)).hit));
}

TYPED_TEST(Accd, ProbeCapReturnsAProvenTime) {
  constexpr PairKind K = TypeParam::kind;
  using T = typename TypeParam::Scalar;
  const auto x0 = stacked<K, T>(T(0.5));
  const auto out = accd<K, T>(x0, first_moved<K, T>(x0, Vec<T, 3>(T(0.3), 0, -2)), T(0), T(0), 1);
  EXPECT_TRUE(out.capped && out.hit);
  EXPECT_EQ(out.probes, 1);
  EXPECT_GT(out.toi, T(0.1));
  EXPECT_LE(out.toi, T(0.25));
}

/// Random motions, near and far from the origin: the proof holds at every sampled time, the rounded committed
/// state keeps a gap above 8 ulps, and a hit is at the stop level.
TYPED_TEST(Accd, RandomMotionsStayAboveTheStopLevel) {
  constexpr PairKind K = TypeParam::kind;
  constexpr int N = TypeParam::n;
  using T = typename TypeParam::Scalar;
  const T eps = std::numeric_limits<T>::epsilon();
  std::mt19937 rng(47);
  int hits = 0, frees = 0;
  for (int k = 0; k < 600; ++k) {
    const double shift = k % 3 == 0 ? 0 : k % 3 == 1 ? 10 : 300;
    const double reach = k % 2 ? 1 : 0.02;  // second half: short motions of close pairs
    Points<double, N> a = random_points<N>(rng), b = a + reach * random_points<N>(rng);
    if (k % 2) b.leftCols(pair_split(K)) = b.leftCols(pair_split(K)) - 2.2 * a.leftCols(pair_split(K));
    const Points<T, N> x0 = (a.array() + shift).matrix().template cast<T>();
    const Points<T, N> x1 = (b.array() + shift).matrix().template cast<T>();
    const T largest = std::max(x0.cwiseAbs().maxCoeff(), x1.cwiseAbs().maxCoeff());
    const T park = k % 5 == 0 ? T(1e-3) : T(0);
    const auto out = accd<K, T>(x0, x1, T(0), park);
    ASSERT_FALSE(out.capped);
    (out.hit ? hits : frees) += 1;
    const Long start = exact_gap<K, T>(x0, x1, 0);
    const Long stop = std::min<Long>(std::max<Long>(park, 16 * eps * largest), start / 2);
    for (int s = 0; s <= 20; ++s) {
      EXPECT_GE((exact_gap<K, T>(x0, x1, out.toi * static_cast<Long>(s) / 20)), stop - 2 * eps * largest);
    }
    if (!out.hit || out.toi == T(0)) continue;
    const Points<T, N> committed = x0 + out.toi * (x1 - x0);
    EXPECT_GT(oracle_closest<K>(committed).d, stop / 2);
    EXPECT_LE((exact_gap<K, T>(x0, x1, out.toi)), stop + 32 * eps * largest);
  }
  EXPECT_GT(hits, K == PairKind::point_point || K == PairKind::point_edge ? -1 : 20);
  EXPECT_GT(frees, 20);
}

TYPED_TEST(Accd, SwappedPairsStopAtTheSameTime) {
  constexpr PairKind K = TypeParam::kind;
  using T = typename TypeParam::Scalar;
  if constexpr (K == PairKind::point_point || K == PairKind::edge_edge) {
    constexpr int half = TypeParam::n / 2;
    const auto swapped = [](const Points<T, TypeParam::n>& x) {
      Points<T, TypeParam::n> out;
      out << x.template rightCols<half>(), x.template leftCols<half>();
      return out;
    };
    std::mt19937 rng(53);
    for (int k = 0; k < 100; ++k) {
      Points<T, TypeParam::n> x0 = random_points<TypeParam::n>(rng).template cast<T>(), x1 = x0;
      x1.template leftCols<half>() = x0.template rightCols<half>();
      x1.template rightCols<half>() = x0.template leftCols<half>();
      const auto a = accd<K, T>(x0, x1, T(0), T(1e-3)),
                 b = accd<K, T>(swapped(x0), swapped(x1), T(0), T(1e-3));
      EXPECT_TRUE(a.hit && b.hit);
      EXPECT_NEAR(a.toi, b.toi, 100 * std::numeric_limits<T>::epsilon());
    }
  }
}

/// A point at height `gap` over a turning triangle, an edge over a turning edge, moving tangentially at t =
/// 1/2: near misses whose other vertices approach fast.
template <PairKind K>
void expect_near_misses_free(double gap) {
  std::mt19937 rng(59);
  std::uniform_real_distribution<double> inside(0.1, 0.4);
  int misses = 0;
  for (int k = 0; k < 400; ++k) {
    Points<double, 4> at = random_points<4>(rng), v = random_points<4>(rng);
    const double a = inside(rng), b = inside(rng);
    const Vec<double, 4> w = K == PairKind::edge_edge ? Vec<double, 4>(1 - 2 * a, 2 * a, 2 * b - 1, -2 * b)
                                                      : Vec<double, 4>(1, a + b - 1, -a, -b);
    const Vec3d e = K == PairKind::edge_edge ? at.col(1) - at.col(0) : at.col(2) - at.col(1);
    const Vec3d f = at.col(3) - at.col(K == PairKind::edge_edge ? 2 : 1);
    const Vec3d n = e.cross(f).normalized();
    at.col(0) += (gap * n - at * w) / w[0];
    v.col(0) -= n * n.dot(v * w) / w[0];
    const Points<double, 4> x0 = at - v / 2, x1 = at + v / 2;
    Long least = 1;  // over time; the exact minimum where the curve bends up, as half of these do
    for (int s = 0; s <= 100; ++s) least = std::min(least, exact_gap<K, double>(x0, x1, s / 100.0L));
    for (Long s = -1e-2L; s <= 1e-2L; s += 1e-3L) {
      least = std::min(least, exact_gap<K, double>(x0, x1, 0.5L + s));
    }
    if (least < 0.7L * static_cast<Long>(gap)) continue;
    const auto out = accd<K, double>(x0, x1, 0.0, 0.0);
    const bool dips = out.hit && exact_gap<K, double>(x0, x1, out.toi) < 1e-12L;
    EXPECT_FALSE(out.capped);
    EXPECT_TRUE(!out.hit || dips) << "gap " << gap;  // a sampled miss may still be a real hit
    misses += !out.hit;
    EXPECT_LE(out.probes, 200);
  }
  EXPECT_GT(misses, 10);
}

TEST(AccdNearMiss, PointTriangle) {
  for (const double gap : {1e-2, 1e-4, 1e-6, 1e-8}) expect_near_misses_free<PairKind::point_triangle>(gap);
}
TEST(AccdNearMiss, EdgeEdge) {
  for (const double gap : {1e-2, 1e-3}) expect_near_misses_free<PairKind::edge_edge>(gap);
}

}  // namespace
