// What a shape declares and what the pipeline relies on: signs, scaling, smoothness at d_hat, limit at 0.
#include <gtest/gtest.h>

#include <limits>

#include "tests/barriers/barrier_cases.hpp"

namespace bb::test::shape_limits_test {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

TEST(ShapeLimits, AreExactlyZeroFromDHatOn) {
  for (const BarrierFunction& fn : all_barriers()) {
    for (const double width : {1e-3, 0.1, 7.0}) {
      for (const double d : {width, std::nextafter(width, 1e9), 2 * width, 1e6 * width}) {
        const ShapeTerms<double> at = fn.eval(d, width);
        const ShapeTerms<float> single = fn.eval(static_cast<float>(2 * d), static_cast<float>(width));
        EXPECT_EQ(at.b, 0) << label(fn);
        EXPECT_EQ(at.db, 0) << label(fn);
        EXPECT_EQ(at.d2b, 0) << label(fn);
        EXPECT_EQ(single.b, 0) << label(fn);
      }
      EXPECT_GT(fn.eval(0.9 * width, width).b, 0) << label(fn);
    }
  }
}

TEST(ShapeLimits, SignsAreThoseOfARepulsiveConvexBarrier) {
  for (const Shape& shape : all_shapes()) {
    const BarrierFunction fn{shape, Argument::gap};
    for (const double u : spaced_u(1e-12, 1e-12)) {
      const ShapeTerms<double> at = fn.eval(u, 1.0);
      EXPECT_GT(at.b, 0) << shape.name << " u = " << u;
      EXPECT_LT(at.db, 0) << shape.name << " u = " << u;
      EXPECT_GT(at.d2b, 0) << shape.name << " u = " << u;
    }
  }
}

TEST(ShapeLimits, ScaleAsSquareMetresBitForBit) {
  for (const BarrierFunction& fn : all_barriers()) {
    for (const double u : spaced_u(1e-6, 1e-6)) {
      const double d_hat = 3e-3, d = u * d_hat;
      const ShapeTerms<double> at = fn.eval(d, d_hat), scaled = fn.eval(4 * d, 4 * d_hat);
      ASSERT_NE(at.b, 0);
      EXPECT_EQ(scaled.b, 16 * at.b) << label(fn) << " u = " << u;
      EXPECT_EQ(scaled.db, 4 * at.db) << label(fn) << " u = " << u;
      EXPECT_EQ(scaled.d2b, at.d2b) << label(fn) << " u = " << u;

      const float d_f = static_cast<float>(d), hat_f = static_cast<float>(d_hat);
      const ShapeTerms<float> single = fn.eval(d_f, hat_f), wide = fn.eval(4 * d_f, 4 * hat_f);
      EXPECT_EQ(wide.b, 16 * single.b) << label(fn) << " u = " << u;
      EXPECT_EQ(wide.db, 4 * single.db) << label(fn) << " u = " << u;
      EXPECT_EQ(wide.d2b, single.d2b) << label(fn) << " u = " << u;
    }
  }
}

/// The first derivative that jumps behaves as e^0 there, the one before as e^1: from b'' ~ e^p near d_hat, p
/// is the declared number of continuous derivatives less one.
TEST(ShapeLimits, SmoothnessAtDHatIsAsDeclared) {
  for (const BarrierFunction& fn : all_barriers()) {
    const double e = 1e-4;
    const double near = fn.eval(1 - e, 1.0).d2b, far = fn.eval(1 - 2 * e, 1.0).d2b;
    const double power = std::log2(far / near);
    EXPECT_NEAR(power, fn.shape.smoothness_at_d_hat - 1, 2e-3) << label(fn);
    // from the outside every derivative is 0
    EXPECT_EQ(fn.eval(1 + e, 1.0).d2b, 0);
  }
}

TEST(ShapeLimits, LimitAtContactIsAsDeclared) {
  for (const BarrierFunction& fn : all_barriers()) {
    const ShapeTerms<double> at = fn.eval(0.0, 2.0);
    const ShapeTerms<float> single = fn.eval(0.0F, 2.0F);
    if (fn.shape.infinite_at_zero) {
      EXPECT_EQ(at.b, inf) << label(fn);
      EXPECT_EQ(at.db, -inf) << label(fn);
      EXPECT_EQ(at.d2b, inf) << label(fn);
      EXPECT_EQ(single.b, std::numeric_limits<float>::infinity()) << label(fn);
      EXPECT_GT(fn.eval(1e-300, 1.0).b, 10 * fn.eval(0.1, 1.0).b) << label(fn);
    } else {
      const ShapeTerms<double> close = fn.eval(2e-12, 2.0);
      ASSERT_GT(at.b, 0) << label(fn);
      EXPECT_NEAR(at.b, close.b, 1e-10) << label(fn);
      EXPECT_NEAR(at.db, close.db, 1e-10) << label(fn);
      EXPECT_NEAR(at.d2b, close.d2b, 1e-10 * std::max(1.0, at.d2b)) << label(fn);
    }
  }
}

TEST(ShapeLimits, TinyGapsAreFiniteOrRightlyInfinite) {
  for (const Shape& shape : all_shapes()) {
    const BarrierFunction fn{shape, Argument::gap};
    for (double u = 1e-300; u < 1e-140; u *= 1e10) {
      const ShapeTerms<double> at = fn.eval(u, 1.0);
      EXPECT_TRUE(std::isfinite(at.b)) << shape.name << " u = " << u;
      EXPECT_TRUE(std::isfinite(at.db)) << shape.name << " u = " << u;
      EXPECT_GT(at.d2b, 0) << shape.name << " u = " << u;
    }
  }
  const ShapeTerms<double> log = barrier("log").eval(1e-300, 1.0);
  EXPECT_LT(relative(log.b, 300 * std::log(10.0)), 1e-14);
  EXPECT_LT(relative(log.db, -1e300), 1e-14);
  EXPECT_EQ(log.d2b, inf);  // 1e600
}

}  // namespace
}  // namespace bb::test::shape_limits_test
