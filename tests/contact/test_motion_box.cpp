// Boxes of motions in floats: they hold what they are boxes of, and their lanes round as one number does.
#include "core/contact/motion_box.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "core/contact/float_rounding.hpp"

namespace bb::motion_box_test {

double number(std::mt19937_64& random) {
  const double mantissa = std::uniform_real_distribution<double>(-1, 1)(random);
  return std::ldexp(mantissa, std::uniform_int_distribution<int>(-170, 120)(random));
}

TEST(MotionBox, LanesRoundAsOneNumberDoes) {
  std::mt19937_64 random(7);
  int below = 0;
  for (int k = 0; k < 20000; ++k) {
    const detail::FourDoubles x{k == 0 ? 0.0 : number(random), k == 1 ? -0.0 : number(random), 1.0 / (k + 1),
                                number(random)};
    const MotionBox::Four lo = detail::floats_below(x), hi = detail::floats_above(x);
    for (int lane = 0; lane < 4; ++lane) {
      const float one = float_below(x[lane]), other = float_above(x[lane]);
      ASSERT_EQ(std::memcmp(
                    &one, reinterpret_cast<const char*>(&lo) + sizeof(float) * static_cast<std::size_t>(lane),
                    sizeof one),
                0)
          << x[lane];
      ASSERT_EQ(
          std::memcmp(&other,
                      reinterpret_cast<const char*>(&hi) + sizeof(float) * static_cast<std::size_t>(lane),
                      sizeof other),
          0)
          << x[lane];
      below += static_cast<double>(one) < x[lane];
      ASSERT_LE(static_cast<double>(one), x[lane]);
      ASSERT_GE(static_cast<double>(other), x[lane]);
    }
  }
  EXPECT_GT(below, 60000) << "hardly a number was rounded";
}

// Of what lies and moves nowhere the fourth lane would be a quotient of subnormal numbers, which takes as long as twenty others.
TEST(MotionBox, TheLaneThatHoldsNothingIsOfNormalNumbers) {
  const Positions x0 = Positions::Random(3, 6), x1 = Positions::Random(3, 6);
  const MotionBox a = motion_box(std::array{0, 1, 2}, 0.01, x0, x1);
  const MotionBox b = motion_box(std::array{3, 4, 5}, 0.01, x0, x1);
  EXPECT_TRUE(std::isnormal(a.lo[3] - b.hi[3]));
  EXPECT_TRUE(std::isnormal(b.lo[3] - a.hi[3]));
  EXPECT_TRUE(std::isnormal(a.slowest[3] - b.fastest[3]));
  EXPECT_TRUE(std::isnormal(b.slowest[3] - a.fastest[3]));
}

}  // namespace bb::motion_box_test
