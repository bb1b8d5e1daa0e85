// The estimated error of an iterate against sequences whose error is known.
#include "core/newton/error_estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace bb {
namespace {

constexpr double unit = 1;  // m, largest coordinate

ErrorEstimate after(const std::vector<double>& dx, double alpha = 1) {
  ErrorEstimate out;
  out.reset(unit);
  for (std::size_t i = 0; i < dx.size(); ++i) {
    if (i > 0) out.took(alpha);
    out.add(dx[i]);
  }
  return out;
}

TEST(ErrorEstimate, of_linear_convergence_is_the_sum_of_all_directions_to_come) {
  for (const double q : {0.1, 0.5, 0.88, 0.97}) {
    std::vector<double> dx{1e-3};
    for (int k = 0; k < 6; ++k) dx.push_back(q * dx.back());
    double to_come = 0;
    for (double next = q * dx.back(); next > 1e-20; next *= q) to_come += next;
    const ErrorEstimate estimate = after(dx);
    ASSERT_TRUE(estimate.contraction().finite());
    EXPECT_NEAR(estimate.contraction().value, q, 1e-12);
    EXPECT_NEAR(estimate.error() / to_come, 1, 1e-9) << q;
  }
}

TEST(ErrorEstimate, bounds_quadratic_convergence_without_an_iteration_more_than_two) {
  const ErrorEstimate estimate = after({1e-2, 1e-4, 1e-8});
  EXPECT_LT(estimate.error(), 1e-11);
  EXPECT_GT(estimate.error(), 1e-16);  // the next direction
}

TEST(ErrorEstimate, one_lucky_ratio_does_not_hide_linear_convergence) {
  const ErrorEstimate lucky = after({1e-3, 9e-4, 9e-6});
  EXPECT_NEAR(lucky.contraction().value, 0.81, 1e-12);
  EXPECT_GT(lucky.error(), 3e-5);
}

TEST(ErrorEstimate, an_unknown_contraction_is_slow) {
  EXPECT_NEAR(after({1e-5}).error(), 9e-5, 1e-12);
  EXPECT_STREQ(after({1e-5}).contraction().status, "first_iteration");
  EXPECT_NEAR(after({1e-3, 1e-5}, 0.5).error(), 9e-5, 1e-12);
  EXPECT_STREQ(after({1e-3, 1e-5}, 0.5).contraction().status, "shortened_step");
  EXPECT_EQ(after({1e-5, 1e-5}).error(), std::numeric_limits<double>::infinity());
}

TEST(ErrorEstimate, at_rounding_of_the_coordinates_the_direction_itself_counts) {
  const double rounding = 4 * std::numeric_limits<double>::epsilon();
  EXPECT_EQ(after({rounding, rounding}).error(), rounding);
  EXPECT_EQ(after({1e-5, 0}).error(), 0);
}

TEST(ErrorEstimate, says_whether_directions_still_fall) {
  std::vector<double> falling{1}, level;
  for (int k = 0; k < 30; ++k) {
    falling.push_back(0.95 * falling.back());
    level.push_back(1 + 0.1 * std::sin(1.3 * k));
  }
  level[3] = 0.5;
  EXPECT_TRUE(after(falling).still_falling());
  EXPECT_FALSE(after(level).still_falling());
  EXPECT_TRUE(after({1, 2, 3}).still_falling());  // too few to say
}

}  // namespace
}  // namespace bb
