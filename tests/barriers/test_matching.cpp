// rho, the matching rules and the conventions of published constants.
#include <gtest/gtest.h>

#include "barriers/matching.hpp"
#include "core/math/error.hpp"
#include "tests/barriers/barrier_cases.hpp"

namespace bb::test::matching_test {
namespace {

TEST(Rho, MatchesTheClosedForms) {
  for (const double u : spaced_u(1e-9, 1e-9)) {
    const double e = (1 - u), l = -std::log1p(-e);
    EXPECT_LT(relative(rho(barrier("quadratic"), u), 1 / e), 1e-14) << u;
    EXPECT_LT(relative(rho(barrier("cubic"), u), 2 / e), 1e-14) << u;
    const double log = (2 * l + 4 * e / u + e * e / (u * u)) / (e * (2 * l + e / u));
    EXPECT_LT(relative(rho(barrier("log"), u), log), 1e-7) << u;
  }
  EXPECT_LT(relative(rho(barrier("log"), 1 - 1e-7), 2e7), 1e-6);  // 2/e near d_hat
  EXPECT_LT(relative(rho(barrier("log"), 1e-9), 1e9), 1e-6);      // 1/u near contact
  // log/cubic -> 1/(2 u)
  EXPECT_LT(relative(rho(barrier("log"), 1e-6) / rho(barrier("cubic"), 1e-6), 0.5e6), 1e-4);
}

TEST(Rho, OfLogHasItsMinimumOfAboutFiveAtPoint376) {
  double best = INFINITY, at = 0;
  for (double u = 0.01; u < 0.99; u += 1e-4) {
    const double value = rho(barrier("log"), u);
    if (value < best) best = value, at = u;
  }
  EXPECT_NEAR(best, 5.03, 5e-3);
  EXPECT_NEAR(at, 0.376, 1e-3);
}

TEST(Rho, IsTheStiffnessPerLoadOfTheRestState) {
  for (const BarrierFunction& fn : all_barriers()) {
    const double kappa = 12, d_hat = 0.02, load = 0.07;
    const Equilibrium rest = equilibrium(fn, kappa, d_hat, load);
    ASSERT_TRUE(rest.d.has_value()) << label(fn);
    EXPECT_LT(relative(rho(fn, *rest.d / d_hat) * load / d_hat, *rest.stiffness), 1e-10) << label(fn);
  }
}

TEST(Rho, RefusesGapsOutsideTheSupport) {
  for (const double u : {0.0, 1.0, -0.5, 2.0, static_cast<double>(NAN)}) {
    EXPECT_THROW(rho(barrier("cubic"), u), ConfigError);
  }
}

TEST(Matching, EqualForceRoundTrips) {
  for (const BarrierFunction& fn : all_barriers()) {
    for (const double theta : {0.01, 0.1, 0.5}) {
      const double d_hat = 1e-3, load = 0.4;
      const double kappa = match_equal_force(fn, d_hat, load, theta);
      EXPECT_LT(relative(-kappa * fn.eval(theta * d_hat, d_hat).db, load), 1e-15) << label(fn);
      // on the square a polynomial carries the load at a larger gap too
      const bool monotone = fn.argument == Argument::gap || fn.shape.infinite_at_zero;
      if (!monotone) continue;
      EXPECT_LT(relative(*equilibrium(fn, kappa, d_hat, load).d, theta * d_hat), 1e-12) << label(fn) << theta;
    }
  }
  EXPECT_DOUBLE_EQ(match_equal_force(barrier("cubic"), 2, 8, 0.5), 8.0);  // |b'| = 2 * 2 * 0.25
  EXPECT_EQ(match_equal_force(barrier("log"), 2, 3), match_equal_force(barrier("log"), 2, 3, 0.1));
}

TEST(Matching, EqualCurvatureRoundTrips) {
  for (const Shape& shape : all_shapes()) {
    const BarrierFunction fn{shape, Argument::gap};
    const double kappa = match_equal_curvature(fn, 1e-3, 250, 0.5);
    EXPECT_LT(relative(kappa * fn.eval(0.5e-3, 1e-3).d2b, 250), 1e-15) << shape.name;
    EXPECT_EQ(kappa, match_equal_curvature(fn, 1e-3, 250)) << shape.name;
  }
  EXPECT_DOUBLE_EQ(match_equal_curvature(barrier("cubic"), 7, 10, 0.5), 5.0);  // b'' = 2
}

TEST(Matching, RefusesWhatHasNoAnswer) {
  EXPECT_THROW(match_equal_force(barrier("log"), 1e-3, 0), ConfigError);
  EXPECT_THROW(match_equal_force(barrier("log"), 0, 1), ConfigError);
  EXPECT_THROW(match_equal_force(barrier("log"), 1e-3, 1, 1.0), ConfigError);
  EXPECT_THROW(match_equal_curvature(barrier("log"), 1e-3, -1), ConfigError);
  // on the square the cubic's curvature is negative near contact
  EXPECT_THROW(match_equal_curvature(barrier("cubic", Argument::squared_gap), 1e-3, 1, 0.1), ConfigError);
}

double kappa_from(const std::string& convention, double constant, double d_hat) {
  return find_named(kappa_conventions(), convention)->kappa(constant, d_hat);
}

/// Each published form, written out, equals kappa b of the shape it is mapped to.
TEST(Conventions, GiveTheSameEnergyAsThePublishedForm) {
  const double d_hat = 0.3, d = 0.12, constant = 17;
  const double cubic = kappa_from("kappa_a_J", constant, d_hat) * barrier("cubic").eval(d, d_hat).b;
  EXPECT_LT(relative(cubic, constant * std::pow(1 - d / d_hat, 3)), 1e-14);

  const double printed = kappa_from("kappa_p_N", constant, d_hat) * barrier("quadratic").eval(d, d_hat).b;
  EXPECT_LT(relative(printed, constant / (2 * d_hat) * (d - d_hat) * (d - d_hat)), 1e-14);

  const double ipc = kappa_from("kappa_ipc_N_per_m3", constant, d_hat) *
                     barrier("log", Argument::squared_gap).eval(d, d_hat).b;
  const double squares = d * d - d_hat * d_hat;
  EXPECT_LT(relative(ipc, -constant * squares * squares * std::log(d * d / (d_hat * d_hat))), 1e-14);
}

}  // namespace
}  // namespace bb::test::matching_test
