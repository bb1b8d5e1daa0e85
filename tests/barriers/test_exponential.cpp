// The shape `exponential` and its exponent: the law it is made for, its capacity, matching, and names with an exponent.
#include <gtest/gtest.h>

#include <algorithm>

#include "barriers/matching.hpp"
#include "core/math/error.hpp"
#include "tests/barriers/barrier_cases.hpp"

namespace bb::test::exponential_test {
namespace {

using Real = long double;
const std::vector<double> exponents{0.5, 1, 3.5, 6, 8, 20, 40};

BarrierFunction with_exponent(double a, Argument argument = Argument::gap) {
  return barrier(("exponential:" + std::to_string(a)).c_str(), argument);
}

/// b, b', b'' at d_hat = 1 from sums of t^k/k!, where nothing cancels.
ShapeTerms<Real> reference(Real a, Real d) {
  const Real t = a * (1 - d);
  Real term = t, p[3] = {0, 0, 0};
  for (int k = 1; k < 400; ++k, term *= t / k) {
    for (int n = 0; n < 3 && n < k; ++n) p[n] += term;
  }
  return {p[2] / (a * std::exp(a)), -p[1] / std::exp(a), a * p[0] / std::exp(a)};
}

TEST(Exponential, MatchesItsSeriesForEveryExponent) {
  for (const double a : exponents) {
    const BarrierFunction fn = with_exponent(a);
    const double joint = 1 - 1 / a;  // below it the formula, above it the sum
    std::vector<double> all = spaced_u(1e-12, 1e-12);
    for (const double u : {joint, std::nextafter(joint, 0), std::nextafter(joint, 1), joint - 1e-3}) {
      if (u > 0 && u < 1) all.push_back(u);
    }
    for (const double u : all) {
      const ShapeTerms<double> at = fn.eval(u, 1.0);
      const ShapeTerms<Real> exact = reference(a, u);
      EXPECT_LT(relative(at.b, static_cast<double>(exact.b)), 2e-14) << a << " " << u;
      EXPECT_LT(relative(at.db, static_cast<double>(exact.db)), 1e-14) << a << " " << u;
      EXPECT_LT(relative(at.d2b, static_cast<double>(exact.d2b)), 1e-14) << a << " " << u;
    }
  }
}

TEST(Exponential, DerivativesAreThoseOfItsDifferences) {
  for (const double a : exponents) {
    const BarrierFunction fn = with_exponent(a);
    for (const double u : {0.01, 0.3, 0.6, 0.9, 0.99}) {
      const double h = 1e-5 * (1 - u);
      const ShapeTerms<double> up = fn.eval(u + h, 1.0), down = fn.eval(u - h, 1.0), at = fn.eval(u, 1.0);
      EXPECT_LT(relative((up.b - down.b) / (2 * h), at.db), 1e-7) << a << " " << u;
      EXPECT_LT(relative((up.db - down.db) / (2 * h), at.d2b), 1e-7) << a << " " << u;
    }
  }
}

TEST(Exponential, RhoIsThatOfTheCubicAtDHatAndTheExponentDeepInside) {
  for (const double a : exponents) {
    const BarrierFunction fn = with_exponent(a);
    for (const double s : {1e-9, 1e-6, 1e-4}) {
      EXPECT_NEAR(rho(fn, 1 - s) * s, 2, a * s + 2e-16 / s) << a << " " << s;
    }
    double before = INFINITY;
    for (double u = 0.999; u > 1e-3; u -= 0.02) {
      EXPECT_GT(rho(fn, u), a) << a << " " << u;
      EXPECT_LE(rho(fn, u), before) << a << " " << u;
      before = rho(fn, u);
    }
  }
  EXPECT_NEAR(rho(with_exponent(40), 1e-6), 40, 1e-12);
  EXPECT_NEAR(rho(barrier("exponential"), 0.1), 6.15, 5e-3);  // the numbers of docs/theory/barriers.md
  EXPECT_NEAR(rho(with_exponent(8), 0.1), 8.04, 5e-3);
}

/// The area law: the force ratio of two gaps is the exponential of the area under rho between them.
TEST(Exponential, CarriesTheLoadRatioThatTheAreaUnderRhoGives) {
  for (const double a : {1.0, 6.0, 20.0}) {
    const BarrierFunction fn = with_exponent(a);
    const double low = 0.1, high = 0.8;
    const int n = 4000;
    double area = 0;
    for (int i = 0; i < n; ++i) area += rho(fn, low + (high - low) * (i + 0.5) / n) * (high - low) / n;
    EXPECT_NEAR(area, std::log(fn.eval(low, 1.0).db / fn.eval(high, 1.0).db), 1e-5) << a;
  }
}

TEST(Exponential, CarriesNoMoreThanItsCapacity) {
  const double kappa = 350, d_hat = 1.7e-3;
  for (const double a : exponents) {
    const double capacity = (1 - (1 + a) * std::exp(-a)) * kappa * d_hat;
    const Equilibrium within = equilibrium(with_exponent(a), kappa, d_hat, 0.999 * capacity);
    ASSERT_FALSE(within.above_capacity) << a;
    EXPECT_LT(relative(*within.capacity, capacity), 1e-12) << a;
    const Equilibrium beyond = equilibrium(with_exponent(a), kappa, d_hat, 1.001 * capacity);
    EXPECT_TRUE(beyond.above_capacity) << a;
    EXPECT_FALSE(beyond.d.has_value()) << a;
  }
}

TEST(Exponential, RestsAtThetaUnderTheLoadThatItIsMatchedTo) {
  const double load = 0.37, d_hat = 2e-3;
  for (const double a : exponents) {
    for (const double theta : {0.5, 0.1, 0.01, 0.001}) {
      const double kappa = match_equal_force(with_exponent(a), d_hat, load, theta);
      const Equilibrium rest = equilibrium(with_exponent(a), kappa, d_hat, load);
      ASSERT_FALSE(rest.above_capacity) << a << " " << theta;
      EXPECT_NEAR(*rest.d, theta * d_hat, 1e-10 * d_hat) << a << " " << theta;
      const double stiffness = rho(with_exponent(a), theta) * load / d_hat;
      EXPECT_LT(relative(*rest.stiffness, stiffness), 1e-8) << a << " " << theta;
    }
  }
}

/// Of a shape whose force falls towards contact: what equal force requires at a theta beyond the peak rests elsewhere.
TEST(Exponential, OnTheSquaredGapAThetaBeyondItsPeakIsNotWhereItRests) {
  const BarrierFunction fn = with_exponent(6, Argument::squared_gap);
  EXPECT_LT(rho(fn, 0.01), 0);
  const double kappa = match_equal_force(fn, 1, 1, 0.01);
  const Equilibrium rest = equilibrium(fn, kappa, 1, 1);
  ASSERT_FALSE(rest.above_capacity);
  EXPECT_GT(*rest.d, 0.3);
}

TEST(Exponential, TheExponentIsPartOfTheName) {
  const std::vector<std::string> names = shape_names();
  EXPECT_NE(std::find(names.begin(), names.end(), "exponential:A"), names.end());
  const BarrierFunction plain = barrier("exponential"), six = barrier("exponential:6"),
                        other = barrier("exponential:8.5");
  EXPECT_EQ(plain.shape.name, "exponential");
  EXPECT_EQ(other.shape.name, "exponential:8.5");
  for (const double u : {0.01, 0.4, 0.9}) {
    EXPECT_EQ(plain.eval(u, 1.0).b, six.eval(u, 1.0).b);
    EXPECT_NE(plain.eval(u, 1.0).b, other.eval(u, 1.0).b);
    const float single = static_cast<float>(u);
    EXPECT_LT(relative(other.eval(single, 1.0F).db, other.eval(static_cast<double>(single), 1.0).db), 1e-5);
  }
  EXPECT_EQ(all_shapes().find("exponential:8"), nullptr);  // no entry of its own
}

TEST(Exponential, AnExponentThatIsNotAllowedIsNamed) {
  for (const char* name : {"exponential:0.4", "exponential:41", "exponential:-6", "exponential:nan",
                           "exponential:", "exponential:6x", "exponential: 6"}) {
    EXPECT_FALSE(find_shape(name)) << name;
    try {
      require_shape(name, "/formulation/shape");
      FAIL() << name;
    } catch (const ConfigError& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find(name), std::string::npos) << text;
      EXPECT_NE(text.find("exponential:A with an exponent A from 0.5 to 40, 6 without one"),
                std::string::npos)
          << text;
      EXPECT_NE(text.find("/formulation/shape"), std::string::npos) << text;
    }
  }
  for (const char* name : {"log:6", "exponentia:6", "exponential6"}) {
    EXPECT_FALSE(find_shape(name)) << name;
    EXPECT_THROW(require_shape(name), ConfigError) << name;
  }
}

}  // namespace
}  // namespace bb::test::exponential_test
