// Signs of determinants: hand cases, extreme scales, and the filter against integers
// on near-degenerate input.
#include "core/audit/predicates.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

namespace bb::audit::predicates_test {
namespace {

TEST(Predicates, self_test_passes_in_this_build) { EXPECT_TRUE(predicates_self_test()); }

TEST(Predicates, signs_have_the_documented_orientation) {
  EXPECT_EQ(orient2d({0, 0}, {1, 0}, {0, 1}), 1);
  EXPECT_EQ(orient2d({0, 0}, {0, 1}, {1, 0}), -1);
  EXPECT_EQ(orient2d({0, 0}, {1, 1}, {3, 3}), 0);
  EXPECT_EQ(orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), 1);
  EXPECT_EQ(orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}), -1);
  EXPECT_EQ(orient3d({0, 0, 7}, {1, 0, 7}, {0, 1, 7}, {5, 5, 7}), 0);
}

TEST(Predicates, one_ulp_off_a_tilted_plane_is_seen) {
  const Vec3d a(0.1, 0.2, 0.3), b(1.1, 0.2, 1.3), c(0.1, 1.2, 1.3);
  const Vec3d on(0.1, 0.2, 0.3);  // a itself: exactly coplanar
  EXPECT_EQ(orient3d(a, b, c, on), 0);
  EXPECT_EQ(orient3d(a, b, c, {on[0], on[1], std::nextafter(on[2], 1.0)}), 1);
  EXPECT_EQ(orient3d(a, b, c, {on[0], on[1], std::nextafter(on[2], 0.0)}), -1);
}

TEST(Predicates, signs_survive_underflow_and_overflow) {
  const double tiny = 0x1p-1000, huge = 0x1p1000;
  EXPECT_EQ(orient3d({0, 0, 0}, {tiny, 0, 0}, {0, tiny, 0}, {0, 0, tiny}), 1);
  EXPECT_EQ(orient3d({0, 0, 0}, {huge, 0, 0}, {0, huge, 0}, {0, 0, -huge}), -1);
  EXPECT_EQ(orient2d({0, 0}, {tiny, 0}, {0, tiny}), 1);
  EXPECT_EQ(orient2d({-huge, 0}, {huge, 0}, {0, -huge}), -1);
  EXPECT_EQ(orient3d({huge, 0, 0}, {huge, 1, 0}, {huge, 0, 1}, {tiny, 0, 0}), -1);
}

TEST(Predicates, filter_agrees_with_integers_near_degeneracy) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::uniform_int_distribution<int> ulps(-2, 2);
  const auto point = [&] { return Vec3d(unit(random), unit(random), unit(random)); };
  int seen[3] = {0, 0, 0}, rounded_wrong = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3d a = point(), b = point(), c = point();
    Vec3d d = a + unit(random) * (b - a) + unit(random) * (c - a);
    for (int k = 0; k < 3; ++k) d[k] += ulps(random) * 0x1p-53;
    const int sign = orient3d_exact(a, b, c, d);
    const double naive = (b - a).cross(c - a).dot(d - a);
    ASSERT_EQ(orient3d(a, b, c, d), sign);
    ASSERT_EQ(orient3d(b, a, c, d), -sign);
    ASSERT_EQ(orient3d(a, b, d, c), -sign);
    rounded_wrong += ((naive > 0) - (naive < 0)) != sign;
    ++seen[sign + 1];
    const Vec2d p = a.head<2>(), q = b.head<2>(), r = p + unit(random) * (q - p);
    ASSERT_EQ(orient2d(p, q, r), orient2d_exact(p, q, r));
    ASSERT_EQ(orient2d(q, p, r), -orient2d_exact(p, q, r));
  }
  EXPECT_GT(seen[0], 100);
  EXPECT_GT(seen[2], 100);
  EXPECT_GT(rounded_wrong, 10) << "the inputs are too easy to test anything";
}

}  // namespace
}  // namespace bb::audit::predicates_test
