// The potential of a stiffness that falls as 1/d^2: against the integral that defines it, its closed form in
// long double and differences, towards both ends; and what is folded from it.
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <stdexcept>

#include "barriers/matching.hpp"
#include "barriers/stiffness/registry.hpp"
#include "core/barrier/folded_barrier.hpp"
#include "core/math/error.hpp"
#include "tests/barriers/barrier_cases.hpp"

namespace bb::test::potentials_test {
namespace {

using Real = long double;
constexpr double d_hat = 2.5e-3;

/// -int_d^{d_hat} b'(s)/s^2 ds by Simpson's rule in ln s; the error falls with the fourth power of the panels' width.
Real integral(const std::function<Real(Real)>& db, Real d, Real end) {
  const int panels = 4000;
  const Real width = std::log(end / d) / panels;
  const auto f = [&](Real t) {
    const Real s = d * std::exp(t);
    return -db(s) / s;
  };
  Real sum = 0;
  for (int i = 0; i < panels; ++i) sum += f(i * width) + 4 * f((i + 0.5L) * width) + f((i + 1) * width);
  return sum * width / 6;
}

struct Reference {
  std::function<Real(Real)> db;   // b'(s)
  std::function<Real(Real)> psi;  // closed form
};

std::map<std::string, Reference> references() {
  const Real h = d_hat;
  std::map<std::string, Reference> r;
  r["cubic"] = {[=](Real s) { return -2 * (h - s) * (h - s) / h; },
                [=](Real d) { return 2 / h * (h * h / d - d - 2 * h * std::log(h / d)); }};
  r["quadratic"] = {[=](Real s) { return -2 * (h - s); },
                    [=](Real d) { return 2 * (h / d - 1 - std::log(h / d)); }};
  return r;
}

BarrierFunction potential(const std::string& shape) { return potential_of(barrier(shape.c_str())); }

TEST(Potentials, AreTheIntegralThatDefinesThem) {
  for (const auto& [name, reference] : references()) {
    int n = 0;
    for (const double u : spaced_u(1e-4, 1e-7)) {
      const double d = u * d_hat, psi = potential(name).eval(d, d_hat).b / (d_hat * d_hat);
      const double expected = static_cast<double>(integral(reference.db, d, d_hat));
      ASSERT_GT(psi, 0) << name << " u = " << u;
      EXPECT_LT(relative(psi, expected), 1e-9) << name << " u = " << u;
      ++n;
    }
    EXPECT_GT(n, 25);
  }
}

TEST(Potentials, MatchTheClosedFormInLongDouble) {
  for (const auto& [name, reference] : references()) {
    for (const double u : spaced_u(1e-100, 0.1, 5)) {  // nearer to d_hat the closed form cancels
      const double d = u * d_hat, psi = potential(name).eval(d, d_hat).b / (d_hat * d_hat);
      EXPECT_LT(relative(psi, static_cast<double>(reference.psi(d))), 4e-15) << name << " u = " << u;
    }
  }
}

/// Leading terms for e = 1 - d/d_hat -> 0: cubic 2/3 e^3 + e^4, quadratic e^2 + 4/3 e^3.
TEST(Potentials, KeepFullPrecisionUpToTheLastGapBelowDHat) {
  for (const double e : {1e-5, 1e-9, 1e-15}) {
    const double d = d_hat * (1 - e), x = (d_hat - d) / d_hat;
    EXPECT_LT(relative(potential("cubic").eval(d, d_hat).b, d_hat * d_hat * x * x * x * (2.0 / 3 + x)), 1e-9);
    EXPECT_LT(relative(potential("quadratic").eval(d, d_hat).b, d_hat * d_hat * x * x * (1 + 4.0 / 3 * x)),
              1e-9);
  }
}

TEST(Potentials, AreSmoothWhereTheSeriesTakesOver) {
  for (const auto& [name, reference] : references()) {
    const double below = 0.5 * d_hat * (1 - 1e-14), above = 0.5 * d_hat * (1 + 1e-14);
    const double jump = potential(name).eval(below, d_hat).b - potential(name).eval(above, d_hat).b;
    const double slope = -potential(name).eval(above, d_hat).db * (above - below);
    EXPECT_NEAR(jump, slope, 4e-15 * potential(name).eval(above, d_hat).b) << name;
  }
}

TEST(Potentials, DerivativesMatchTheLadderOfDifferences) {
  for (const auto& [name, reference] : references()) {
    const BarrierFunction fn = potential(name);
    int n = 0;
    for (const double u : spaced_u(1e-8, 5e-6)) {
      const double d = u * d_hat;
      const ShapeTerms<double> at = fn.eval(d, d_hat), b = barrier(name.c_str()).eval(d, d_hat);
      double first = INFINITY, second = INFINITY;
      for (int k = 1; k <= 8; ++k) {
        const double h = std::pow(10.0, -k) * std::min(d, d_hat - d), up = d + h, down = d - h;
        const ShapeTerms<double> plus = fn.eval(up, d_hat), minus = fn.eval(down, d_hat);
        first = std::min(first, relative((plus.b - minus.b) / (up - down), at.db));
        second = std::min(second, relative((plus.db - minus.db) / (up - down), at.d2b));
      }
      EXPECT_LT(first, 1e-6) << name << " u = " << u;
      EXPECT_LT(second, 1e-6) << name << " u = " << u;
      EXPECT_LT(relative(at.db, b.db / (u * u)), 1e-14);
      ++n;
    }
    EXPECT_GT(n, 30);
  }
}

TEST(Potentials, ScaleEndAndStartAsBarriersDo) {
  for (const auto& [name, reference] : references()) {
    const BarrierFunction fn = potential(name);
    for (const double u : {1e-3, 0.3, 0.8, 0.999}) {
      const ShapeTerms<double> one = fn.eval(u * d_hat, d_hat), four = fn.eval(4 * u * d_hat, 4 * d_hat);
      EXPECT_EQ(four.b, 16 * one.b);
      EXPECT_EQ(four.db, 4 * one.db);
      EXPECT_EQ(four.d2b, one.d2b);
      const ShapeTerms<float> single = fn.eval(static_cast<float>(u * d_hat), static_cast<float>(d_hat));
      EXPECT_LT(relative(static_cast<double>(single.db), one.db), 1e-3) << u;
    }
    for (const double d : {d_hat, 2 * d_hat}) {
      const ShapeTerms<double> outside = fn.eval(d, d_hat);
      EXPECT_TRUE(outside.b == 0 && outside.db == 0 && outside.d2b == 0);
    }
    const ShapeTerms<double> touching = fn.eval(0, d_hat);
    EXPECT_EQ(touching.b, INFINITY);
    EXPECT_EQ(touching.db, -INFINITY);
    EXPECT_EQ(touching.d2b, INFINITY);
    EXPECT_TRUE(fn.shape.infinite_at_zero);
  }
}

/// Claim N1: the true force 2 m (d_hat - d)^2/(d_hat d^2) has rho = 2/(1 - u) + 2/u, above log's at every gap.
TEST(Potentials, RhoOfTheCubicIsAboveThatOfTheLogAtEveryGap) {
  EXPECT_NEAR(rho(potential("cubic"), 0.1), 22.2, 0.05);
  EXPECT_NEAR(rho(barrier("log"), 0.1), 9.9, 0.05);
  for (const double u : spaced_u(1e-3, 1e-3)) {
    EXPECT_NEAR(rho(potential("cubic"), u), 2 / (1 - u) + 2 / u, 1e-9 * (2 / (1 - u) + 2 / u));
    EXPECT_GT(rho(potential("cubic"), u), rho(barrier("log"), u)) << u;
  }
}

/// E' and E'' of both parts together, against differences of E and E'.
TEST(FoldedBarrier, ItsForceAndCurvatureAreDerivativesOfItsEnergy) {
  int n = 0;
  for (const auto& [name, reference] : references()) {
    const BarrierFunction fn = barrier(name.c_str());
    FoldedBarrier folded(fn);
    const KappaParts parts{7, 3e-6};
    const auto at = [&](double d) {
      ShapeTerms<double> out;
      folded.eval(1, &d, &d_hat, &parts, &out.b, &out.db, &out.d2b);
      return out;
    };
    for (const double u : {0.01, 0.2, 0.49, 0.51, 0.9, 0.99}) {
      const double d = u * d_hat, h = 1e-5 * std::min(d, d_hat - d);
      const ShapeTerms<double> one = at(d), up = at(d + h), down = at(d - h), b = fn.eval(d, d_hat);
      const double kappa = parts.at(d), slope = -2 * parts.per_gap_sq / (d * d * d);
      EXPECT_LT(relative(one.db, kappa * b.db), 1e-13);
      EXPECT_LT(relative(one.d2b, kappa * b.d2b + slope * b.db), 1e-13);
      EXPECT_LT(relative((up.b - down.b) / (2 * h), one.db), 1e-7) << name << u;
      EXPECT_LT(relative((up.db - down.db) / (2 * h), one.d2b), 1e-7) << name << u;
      ++n;
    }
  }
  EXPECT_EQ(n, 12);
}

TEST(FoldedBarrier, IsRefusedWhereThereIsNoPotential) {
  EXPECT_EQ(shapes_with_potential(), "quadratic, cubic");
  for (const char* shape : {"log", "log_squared", "two_stage", "exponential", "minimax_bounded", "minimax"}) {
    EXPECT_FALSE(has_potential(barrier(shape)));
    EXPECT_THROW(FoldedBarrier{barrier(shape)}, std::logic_error);
  }
  EXPECT_FALSE(has_potential(barrier("cubic", Argument::squared_gap)));
  EXPECT_TRUE(has_potential(barrier("cubic")));
}

/// What a policy reports of its own settings: place, value and what is allowed.
TEST(KappaDerivative, IsIncludedOnlyPerStepAndWhereKappaDependsOnTheGap) {
  const auto refusal = [](const char* mass_term, const char* refresh) -> std::vector<Violation> {
    PolicyConfig config;
    config.name = "elasticity_inclusive";
    config.parameters.emplace("mass_term", std::string(mass_term));
    config.parameters.emplace("refresh", std::string(refresh));
    config.parameters.emplace("derivative", std::string("included"));
    try {
      EXPECT_TRUE(make_policy(config)->has_potential());
    } catch (const ConfigError& error) {
      return error.violations();
    }
    return {};
  };
  EXPECT_TRUE(refusal("paper", "per_step").empty());
  EXPECT_TRUE(refusal("scaled", "per_step").empty());
  const std::vector<Violation> often = refusal("paper", "per_iteration");
  ASSERT_EQ(often.size(), 1U);
  EXPECT_EQ(often[0].where, "stiffness_policy/refresh");
  EXPECT_EQ(often[0].found, "\"per_iteration\"");
  EXPECT_NE(often[0].allowed.find("per_step"), std::string::npos);
  for (const char* mass_term : {"inertia", "none"}) {
    const std::vector<Violation> flat = refusal(mass_term, "per_step");
    ASSERT_EQ(flat.size(), 1U);
    EXPECT_EQ(flat[0].where, "stiffness_policy/derivative");
    EXPECT_NE(flat[0].found.find(mass_term), std::string::npos);
    EXPECT_NE(flat[0].allowed.find("paper or scaled"), std::string::npos);
  }
}

}  // namespace
}  // namespace bb::test::potentials_test
