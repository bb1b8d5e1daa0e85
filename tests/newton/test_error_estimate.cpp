// The estimated error of an iterate against sequences whose error is known.
#include "core/newton/error_estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace bb::error_estimate_test {
namespace {

ErrorEstimate after(const std::vector<double>& dx, double alpha = 1) {
  ErrorEstimate out;
  out.reset();
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

TEST(ErrorEstimate, one_ratio_alone_promises_no_quadratic_convergence) {
  const ErrorEstimate one = after({1e-3, 1e-6}), two = after({1e-2, 1e-3, 1e-6});
  EXPECT_NEAR(one.contraction().value, 0.81, 1e-12);
  EXPECT_NEAR(two.contraction().value, 0.01, 1e-12);
  EXPECT_NEAR(after({1, 1e-2, 1e-3, 1e-6}, 0.5).error(), 9e-6,
              1e-12);  // nothing is known after part of a step
  ErrorEstimate again = after({1, 1e-1});
  again.took(0.5);
  again.add(1e-2);
  again.took(1);
  again.add(1e-5);
  EXPECT_NEAR(again.contraction().value, 0.81, 1e-12);  // the ratios before the part do not count
}

TEST(ErrorEstimate, the_residual_that_a_solve_left_bounds_the_contraction) {
  ErrorEstimate estimate = after({1e-2, 1e-4});
  estimate.took(1);
  estimate.add(1e-8, 0.05);
  EXPECT_NEAR(estimate.contraction().value, 0.05, 1e-12);
  EXPECT_NEAR(estimate.error(), 1e-8 * 0.05 / 0.95, 1e-20);
  EXPECT_LT(after({1e-2, 1e-4, 1e-8}).error(), estimate.error());
}

/// Directions of a sequence of errors that shrinks by q and by a square at once: e' = q e + c e^2.
TEST(ErrorEstimate, is_never_below_a_third_of_the_truth) {
  for (const double q : {0.0, 1e-3, 0.05, 0.3, 0.7, 0.95}) {
    for (const double c : {0.0, 0.5, 5.0}) {
      for (const double start : {1e-4, 1e-2, 0.05}) {
        std::vector<double> dx;
        double error = start;
        for (int k = 0; k < 12 && error > 1e-15; ++k) {
          const double next = q * error + c * error * error;
          dx.push_back(error - next);
          error = next;
          if (dx.back() <= 0) break;
          if (k == 0 && next > 0.9 * dx.back() / 0.1) continue;  // slower than an unknown q is taken for
          EXPECT_GE(3 * after(dx).error(), error) << q << " " << c << " " << start << " " << k;
        }
        EXPECT_GT(dx.size(), 0U);
      }
    }
  }
}

TEST(ErrorEstimate, within_rounding_a_direction_counts_as_it_is) {
  ErrorEstimate estimate = after({1e-5, 9e-6, 8e-6});
  estimate.took(1);
  estimate.add(0, 0, 3e-16);  // nothing stands out of rounding
  EXPECT_EQ(estimate.error(), 3e-16);
  ErrorEstimate mixed = after({1e-5, 1e-7});
  mixed.took(1);
  mixed.add(1e-9, 0, 1e-6);  // a far body whose coordinates know no better
  EXPECT_EQ(mixed.error(), 1e-6);
  EXPECT_NEAR(mixed.contraction().value, 1e-2, 1e-12);
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

/// The smallest of the last ten against the smallest of all before them: one of either, wherever they stand.
TEST(ErrorEstimate, says_that_directions_that_come_back_to_their_size_do_not_fall) {
  std::vector<double> cycle;
  for (int k = 0; k < 24; ++k) cycle.push_back(k % 3 == 0 ? 1 : 2);
  EXPECT_FALSE(after(cycle).still_falling());
  EXPECT_FALSE(after(std::vector<double>(11, 1.0)).still_falling());
  for (std::size_t place = cycle.size() - 10; place < cycle.size(); ++place) {
    std::vector<double> falling = cycle;
    falling[place] = std::nextafter(1.0, 0.0);
    EXPECT_TRUE(after(falling).still_falling()) << place;
  }
  std::vector<double> before = cycle;
  before[cycle.size() - 11] = 0.5;  // smaller, but longer ago
  EXPECT_FALSE(after(before).still_falling());
}

TEST(ErrorEstimate, needs_eleven_directions_to_say_that_they_do_not_fall) {
  std::vector<double> growing;
  for (int k = 0; k < 11; ++k) {
    EXPECT_TRUE(growing.empty() || after(growing).still_falling()) << k;
    growing.push_back(1 + k);
  }
  EXPECT_FALSE(after(growing).still_falling());
}

}  // namespace
}  // namespace bb::error_estimate_test
