// The largest force that a barrier has, on shapes whose maximum is known.
#include "core/barrier/slope_scan.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "barriers/shapes/registry.hpp"

namespace bb::slope_scan_test {
namespace {

constexpr double d_hat = 0.02;

/// 2 (d_hat - d) and 2 (d_hat - d)^2/d_hat are largest at d = 0, which no sample reaches.
TEST(MaxSlope, OfABoundedShapeOnTheGapIsThatAtZero) {
  for (const char* shape : {"quadratic", "cubic"}) {
    const auto slope = max_slope({require_shape(shape), Argument::gap}, d_hat);
    ASSERT_TRUE(slope) << shape;
    EXPECT_NEAR(*slope / (2 * d_hat), 1, 1e-6) << shape;
  }
}

/// b = (d_hat^2 - d^2)^2/d_hat^2 has |b'| = 4 d (d_hat^2 - d^2)/d_hat^2: largest at d_hat/sqrt(3).
/// (1 - (1 + a) exp(-a)) d_hat at d = 0, a = 6.
TEST(MaxSlope, OfTheExponentialIsThatAtZero) {
  const auto slope = max_slope({require_shape("exponential"), Argument::gap}, d_hat);
  ASSERT_TRUE(slope);
  EXPECT_NEAR(*slope / ((1 - 7 * std::exp(-6.0)) * d_hat), 1, 1e-6);
}

TEST(MaxSlope, InsideTheSupportIsFound) {
  const auto slope = max_slope({require_shape("quadratic"), Argument::squared_gap}, d_hat);
  ASSERT_TRUE(slope);
  EXPECT_NEAR(*slope / (8 * d_hat / (3 * std::sqrt(3.0))), 1, 1e-12);
}

TEST(MaxSlope, OfAnUnboundedShapeThereIsNone) {
  for (const char* shape : {"log", "log_squared", "two_stage", "minimax"}) {
    EXPECT_FALSE(max_slope({require_shape(shape), Argument::gap}, d_hat)) << shape;
  }
}

}  // namespace
}  // namespace bb::slope_scan_test
