// Springs: derivatives, projection, the coincident limit.
#include <gtest/gtest.h>

#include "core/energy/spring.hpp"
#include "tests/energy/energy_cases.hpp"

namespace bb::test::spring_test {
namespace {

constexpr double stiffness = 7.0;

class SpringState : public testing::TestWithParam<double> {
};  // rest length; the length is sqrt(0.14) = 0.374

const Vec<double, 6> state{{0.1, 0.2, 0.3, 0.2, 0.4, 0.0}};

TEST_P(SpringState, DerivativesAndProjection) {
  const double rest_length = GetParam();
  const VecXl x = state.cast<Long>();
  const auto closed_form = [&](const VecXl& at) {
    const Long stretch = (at.tail<3>() - at.head<3>()).norm() - Long(rest_length);
    return Long(stiffness) / 2 * stretch * stretch;
  };
  const auto gradient = [&](const VecXl& at) {
    return spring_terms<Long>(Points<Long, 2>(at).x, stiffness, rest_length, Projection::none).grad;
  };
  const Points<double, 2> p(state);
  const auto exact = spring_terms<double>(p.x, stiffness, rest_length, Projection::none);
  const auto psd = spring_terms<double>(p.x, stiffness, rest_length, Projection::psd);
  EXPECT_LT(gradient_error(closed_form, x, exact.grad), 1e-10);
  EXPECT_LT(jacobian_error(gradient, x, exact.hess), 1e-10);
  EXPECT_NEAR(exact.energy, static_cast<double>(closed_form(x)), 1e-15);
  EXPECT_EQ(exact.energy, spring_value<double>(p.x, stiffness, rest_length));
  EXPECT_EQ(exact.hess, exact.hess.transpose());
  EXPECT_LT(relative_difference(psd.hess, clamped(exact.hess), stiffness), 1e-12);
  EXPECT_EQ(psd.grad, exact.grad);

  const auto single =
      spring_terms<float>(Points<float, 2>(state).x, float(stiffness), float(rest_length), Projection::psd);
  EXPECT_LT(relative_difference(single.hess.cast<double>(), psd.hess, stiffness), 1e-5);
  EXPECT_LT(relative_difference(single.grad.cast<double>(), psd.grad, stiffness), 1e-5);
}
INSTANTIATE_TEST_SUITE_P(StretchedNearRestCompressed, SpringState, testing::Values(0.0, 0.2, 0.374, 0.9));

TEST(Spring, CompressionIsIndefiniteAndProjectionChangesIt) {
  const Points<double, 2> p(state);
  const auto exact = spring_terms<double>(p.x, stiffness, 0.9, Projection::none);
  const auto psd = spring_terms<double>(p.x, stiffness, 0.9, Projection::psd);
  EXPECT_GT((exact.hess - psd.hess).norm(), 1);
}

TEST(Spring, CoincidentPointsGiveFiniteTerms) {
  const Vec3d x[2] = {Vec3d(1, 2, 3), Vec3d(1, 2, 3)};
  const auto cusp = spring_terms<double>(x, stiffness, 0.5, Projection::psd);
  EXPECT_EQ(cusp.energy, stiffness / 2 * 0.25);
  EXPECT_TRUE(cusp.grad.isZero(0));
  EXPECT_TRUE(cusp.hess.isZero(0));
  const auto smooth = spring_terms<double>(x, stiffness, 0.0, Projection::none);
  EXPECT_EQ(smooth.hess(0, 0), stiffness);
  EXPECT_EQ(smooth.hess(0, 3), -stiffness);
}

}  // namespace
}  // namespace bb::test::spring_test
