// One contact under a load against closed forms, for every shape and over 24 decades of load.
#include <gtest/gtest.h>

#include <limits>

#include "barriers/matching.hpp"
#include "core/math/error.hpp"
#include "tests/barriers/barrier_cases.hpp"

namespace bb::test::equilibrium_laws_test {
namespace {

constexpr double kappa = 350, d_hat = 1.7e-3, unit = kappa * d_hat;  // N
constexpr double tolerance = 1e-9;

std::vector<double> loads(double highest) {
  std::vector<double> all;
  for (double f = 1e-12; f < highest; f *= 3.7) all.push_back(f * unit);
  return all;
}

void expect_rest(const Equilibrium& rest, double d, double stiffness, double load) {
  ASSERT_FALSE(rest.above_capacity) << "load " << load;
  ASSERT_GT(*rest.d, 0);
  EXPECT_LT(relative(*rest.d, d), tolerance) << "load " << load;
  EXPECT_LT(relative(*rest.stiffness, stiffness), tolerance) << "load " << load;
}

TEST(EquilibriumLaws, Quadratic) {
  for (const double f : loads(2)) {
    const Equilibrium rest = equilibrium(barrier("quadratic"), kappa, d_hat, f);
    expect_rest(rest, d_hat * (1 - f / (2 * unit)), 2 * kappa, f);
    EXPECT_LT(relative(*rest.capacity, 2 * unit), tolerance);
  }
}

TEST(EquilibriumLaws, Cubic) {
  for (const double f : loads(2)) {
    const Equilibrium rest = equilibrium(barrier("cubic"), kappa, d_hat, f);
    expect_rest(rest, d_hat * (1 - std::sqrt(f / (2 * unit))), std::sqrt(8 * kappa * f / d_hat), f);
    EXPECT_LT(relative(*rest.capacity, 2 * unit), tolerance);
  }
}

/// So close to d_hat the rounding of the gap alone would spoil K = 4 kappa e by up to 1e-6.
TEST(EquilibriumLaws, StiffnessKeepsItsPrecisionUnderTinyLoads) {
  for (const double share : {1e-20, 3e-18, 7e-16, 1e-14}) {
    const double f = share * unit;
    const Equilibrium rest = equilibrium(barrier("cubic"), kappa, d_hat, f);
    expect_rest(rest, d_hat * (1 - std::sqrt(f / (2 * unit))), std::sqrt(8 * kappa * f / d_hat), f);
  }
}

TEST(EquilibriumLaws, ArticlesCubicInItsOwnConstant) {
  const double kappa_a = 0.02;  // J
  const double in_n_per_m = find_named(kappa_conventions(), "kappa_a_J")->kappa(kappa_a, d_hat);
  for (const double share : {1e-8, 1e-3, 0.2, 0.9}) {
    const double capacity = 3 * kappa_a / d_hat, f = share * capacity;
    const Equilibrium rest = equilibrium(barrier("cubic"), in_n_per_m, d_hat, f);
    expect_rest(rest, d_hat * (1 - std::sqrt(f * d_hat / (3 * kappa_a))),
                std::sqrt(12 * kappa_a * f / std::pow(d_hat, 3)), f);
    EXPECT_LT(relative(*rest.capacity, capacity), tolerance);
  }
}

/// The log law f = kappa d_hat e (e/u - 2 ln u), solved here by bisection in long double.
long double log_rest_u(long double load_in_units) {
  long double low = 0, high = 1;
  for (int i = 0; i < 400; ++i) {
    const long double u = (low + high) / 2, e = 1 - u;
    (e * (e / u - 2 * std::log(u)) > load_in_units ? low : high) = u;
  }
  return (low + high) / 2;
}

TEST(EquilibriumLaws, Log) {
  for (const double f : loads(1e12)) {
    const Equilibrium rest = equilibrium(barrier("log"), kappa, d_hat, f);
    const long double u = log_rest_u(static_cast<long double>(f) / unit), e = 1 - u;
    const long double stiffness = kappa * (-2 * std::log(u) + 4 * e / u + e * e / (u * u));
    expect_rest(rest, static_cast<double>(u * d_hat), static_cast<double>(stiffness), f);
    EXPECT_FALSE(rest.capacity.has_value());
  }
  const double large = 1e12 * unit;  // -> kappa d_hat^2/f and f^2/(kappa d_hat^2)
  const Equilibrium rest = equilibrium(barrier("log"), kappa, d_hat, large);
  EXPECT_LT(relative(*rest.d, kappa * d_hat * d_hat / large), 1e-9);
  EXPECT_LT(relative(*rest.stiffness, large * large / (kappa * d_hat * d_hat)), 1e-9);
}

TEST(EquilibriumLaws, TwoStageBelowAndAboveItsJoint) {
  for (const double f : loads(1e12)) {
    const Equilibrium rest = equilibrium(barrier("two_stage"), kappa, d_hat, f);
    // |b'| = d_hat at the joint
    if (f < unit) {
      expect_rest(rest, d_hat - f / (2 * kappa), 2 * kappa, f);
    } else {
      expect_rest(rest, kappa * d_hat * d_hat / (2 * f), 2 * f * f / (kappa * d_hat * d_hat), f);
    }
  }
}

/// kappa = m/d^2 (mass term of the paper): d = d_hat/(1 + s), K = 4 m s (1 + s)/d_hat^2, s =
/// sqrt(f d_hat/(2 m)).
TEST(EquilibriumLaws, CubicWithStiffnessFromMass) {
  const double mass = 1e-7;
  for (const double f : {1e-6, 1e-4, 1e-2, 1.0}) {
    const double s = std::sqrt(f * d_hat / (2 * mass)), d = d_hat / (1 + s);
    const double dynamic = mass / (d * d);
    const Equilibrium rest = equilibrium(barrier("cubic"), dynamic, d_hat, f);
    expect_rest(rest, d, 4 * mass * s * (1 + s) / (d_hat * d_hat), f);
  }
}

/// A law on the square: load/(kappa d_hat) as a function of u, its largest value and where it is.
struct SquareLaw {
  const char* shape;
  long double (*load)(long double u);
  long double (*stiffness)(long double u);  // K/kappa
  double peak_u, peak;
};
const SquareLaw square_laws[] = {
    {"quadratic", [](long double u) { return 4 * u * (1 - u * u); },
     [](long double u) { return 12 * u * u - 4; }, 1 / std::sqrt(3.0), 4 / std::sqrt(3.0) * (2.0 / 3)},
    {"cubic", [](long double u) { return 4 * u * (1 - u * u) * (1 - u * u); },
     [](long double u) { return 4 * (1 - u * u) * (5 * u * u - 1); }, 1 / std::sqrt(5.0),
     4 / std::sqrt(5.0) * (16.0 / 25)}};

/// On the square the force rises to a maximum, then falls to 0 at contact: the rest gap is the larger root.
TEST(EquilibriumLaws, PolynomialsOnTheSquareHaveAnInteriorMaximum) {
  for (const SquareLaw& law : square_laws) {
    const BarrierFunction fn = barrier(law.shape, Argument::squared_gap);
    for (const double share : {1e-12, 1e-9, 1e-6, 1e-3, 0.1, 0.5, 0.99}) {
      const double f = share * law.peak * unit;
      long double low = law.peak_u, high = 1;
      for (int i = 0; i < 200; ++i) {
        const long double u = (low + high) / 2;
        (law.load(u) > static_cast<long double>(f) / unit ? low : high) = u;
      }
      const Equilibrium rest = equilibrium(fn, kappa, d_hat, f);
      expect_rest(rest, static_cast<double>(low * d_hat), static_cast<double>(kappa * law.stiffness(low)), f);
      EXPECT_LT(relative(*rest.capacity, law.peak * unit), 1e-14);
    }
    const Equilibrium over = equilibrium(fn, kappa, d_hat, 1.000001 * law.peak * unit);
    EXPECT_TRUE(over.above_capacity);
    EXPECT_FALSE(over.d.has_value());
  }
}

TEST(Equilibrium, LoadOfTheCapacityIsAboveIt) {
  for (const char* shape : {"quadratic", "cubic"}) {
    const Equilibrium at = equilibrium(barrier(shape), kappa, d_hat, 2 * kappa * d_hat);
    EXPECT_TRUE(at.above_capacity) << shape;
    EXPECT_FALSE(at.d.has_value()) << shape;
    EXPECT_FALSE(at.stiffness.has_value()) << shape;
    EXPECT_FALSE(equilibrium(barrier(shape), kappa, d_hat, 1.999 * unit).above_capacity) << shape;
  }
}

TEST(Equilibrium, BalancesTheLoadForEveryBarrier) {
  for (const BarrierFunction& fn : all_barriers()) {
    int compared = 0;
    for (const double f : loads(1e12)) {
      const Equilibrium rest = equilibrium(fn, kappa, d_hat, f);
      if (rest.above_capacity) continue;
      const ShapeTerms<double> at = fn.eval(*rest.d, d_hat);
      // the balance is as good as the rounding of the gap (and of its square) allows
      const double rounding = 8 * *rest.stiffness * d_hat * std::numeric_limits<double>::epsilon();
      EXPECT_NEAR(-kappa * at.db, f, rounding + 1e-12 * f) << label(fn) << " load " << f;
      EXPECT_LT(relative(*rest.stiffness, kappa * at.d2b), 1e-8) << label(fn) << " load " << f;
      EXPECT_EQ(rest.capacity.has_value(), !fn.shape.infinite_at_zero) << label(fn);
      ++compared;
    }
    EXPECT_GT(compared, 10) << label(fn);
  }
}

TEST(Equilibrium, RefusesWhatIsNotPositive) {
  EXPECT_THROW(equilibrium(barrier("log"), 0, d_hat, 1), ConfigError);
  EXPECT_THROW(equilibrium(barrier("log"), 1, -d_hat, 1), ConfigError);
  EXPECT_THROW(equilibrium(barrier("log"), 1, d_hat, 0), ConfigError);
  EXPECT_THROW(equilibrium(barrier("log"), 1, d_hat, NAN), ConfigError);
}

}  // namespace
}  // namespace bb::test::equilibrium_laws_test
