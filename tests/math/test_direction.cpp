// Directions of any size are the same direction.
#include <gtest/gtest.h>

#include <limits>

#include "core/math/direction.hpp"

namespace bb::test::direction_test {
namespace {

TEST(Direction, OfAnySizeHasItsLargestComponentBetweenOneAndTwo) {
  int n_scaled = 0;
  for (const int exponent : {-1074, -1060, -400, 400, 1022}) {
    const Vec3d tiny = Vec3d(0.75, -1.5, 0.25).unaryExpr([=](double x) { return std::ldexp(x, exponent); });
    const Vec3d usual = of_usual_size(tiny);
    EXPECT_GE(usual.cwiseAbs().maxCoeff(), 1) << exponent;
    EXPECT_LT(usual.cwiseAbs().maxCoeff(), 2) << exponent;
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(usual[c] * tiny.cwiseAbs().maxCoeff(), tiny[c] * usual.cwiseAbs().maxCoeff()) << exponent;
    }
    n_scaled += usual != tiny;
  }
  EXPECT_EQ(n_scaled, 5);
  EXPECT_EQ(of_usual_size({0, 0, std::numeric_limits<double>::denorm_min()}), Vec3d(0, 0, 1));
  EXPECT_EQ(of_usual_size({1e-3, 0, 40}), Vec3d(1e-3, 0, 40));
}

}  // namespace
}  // namespace bb::test::direction_test
