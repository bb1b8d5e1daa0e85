// The edge-edge mollifier against differences in long double, its closed value and its ends.
#include "core/geometry/edge_edge_mollifier.hpp"

#include <gtest/gtest.h>

#include "tests/geometry/closest_oracle.hpp"

namespace {

using namespace bb;
using namespace bb::test;

TEST(EdgeEdgeMollifier, ValueAtAKnownAngle) {
  Points<double, 4> x;
  x << 0, 2, 0, 3, 0, 0, 0, 0.1, 0, 0, 1, 1;  // |ea x eb|^2 = 0.04
  EXPECT_NEAR(edge_edge_cross_squared(x), 0.04, 1e-16);
  EXPECT_NEAR(edge_edge_mollifier_threshold(x), 1e-3 * 4 * 9.01, 1e-15);
  EXPECT_NEAR(edge_edge_mollifier_value(x, 0.1), 0.8 - 0.16, 1e-15);
  EXPECT_EQ(edge_edge_mollifier_value(x, 0.04), 1);
  EXPECT_EQ(edge_edge_mollifier(x, 0.04).gradient.norm(), 0);
  EXPECT_EQ(edge_edge_mollifier(x, 0.04).hessian.norm(), 0);
  x(1, 3) = 0;
  EXPECT_EQ(edge_edge_mollifier_value(x, 0.1), 0);
}

TEST(EdgeEdgeMollifier, DerivativesMatchDifferences) {
  std::mt19937 rng(41);
  for (int k = 0; k < 20; ++k) {
    const Points<double, 4> x = random_points<4>(rng);
    const double eps = 1.5 * edge_edge_cross_squared(x);
    const auto out = edge_edge_mollifier(x, eps);
    ASSERT_GT(out.gradient.norm(), 0);
    EXPECT_EQ(out.value, edge_edge_mollifier_value(x, eps));
    const double scale = out.hessian.cwiseAbs().maxCoeff();
    for (int a = 0; a < 12; ++a) {
      Long first = 1e9L, second = 1e9L;
      for (const Long h : {1e-4L, 1e-5L, 1e-6L, 1e-7L}) {
        Points<Long, 4> up = x.cast<Long>(), down = up;
        up(a % 3, a / 3) += h;
        down(a % 3, a / 3) -= h;
        const auto p = edge_edge_mollifier<Long>(up, eps), m = edge_edge_mollifier<Long>(down, eps);
        first = std::min(first, std::abs((p.value - m.value) / (2 * h) - static_cast<Long>(out.gradient[a])));
        const Vec<Long, 12> column = (p.gradient - m.gradient) / (2 * h);
        second = std::min(second, (column - out.hessian.col(a).cast<Long>()).cwiseAbs().maxCoeff());
      }
      EXPECT_LE(static_cast<double>(first), 1e-9 * scale);
      EXPECT_LE(static_cast<double>(second), 1e-9 * scale);
    }
  }
}

TEST(EdgeEdgeMollifier, ValueAndSlopeAreContinuousAtTheThreshold) {
  std::mt19937 rng(43);
  const Points<double, 4> x = random_points<4>(rng);
  const double c = edge_edge_cross_squared(x);
  const auto below = edge_edge_mollifier(x, c * (1 + 1e-9)), far_below = edge_edge_mollifier(x, c * 2);
  EXPECT_NEAR(below.value, 1, 1e-15);
  EXPECT_GT(far_below.gradient.norm(), 0.1);
  EXPECT_LE(below.gradient.norm(), 1e-7 * far_below.gradient.norm());
}

}  // namespace
