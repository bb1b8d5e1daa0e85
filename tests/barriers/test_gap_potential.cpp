// The potential of a stiffness that is any function of the gap: against closed forms in long double, against the potential of
// 1/d^2, differences, and what is refused.
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "core/barrier/folded_barrier.hpp"
#include "core/barrier/gap_potential.hpp"
#include "tests/barriers/barrier_cases.hpp"

namespace bb::test::gap_potential_test {
namespace {

using Real = long double;
constexpr double d_hat = 2.5e-3;

/// kappa = fixed f(d), f and its slope as a test writes them.
class Given final : public GapStiffness {
 public:
  using Function = std::function<double(double)>;
  Given(Function f, Function slope) : f_(std::move(f)), slope_(std::move(slope)) {}
  void eval(const KappaParts& frozen, double, std::size_t n, const double* d, double* kappa,
            double* slope) const override {
    for (std::size_t i = 0; i < n; ++i) {
      kappa[i] = frozen.fixed * f_(d[i]);
      slope[i] = frozen.fixed * slope_(d[i]);
    }
  }

 private:
  Function f_, slope_;
};

Given constant() {
  return {[](double) { return 1.0; }, [](double) { return 0.0; }};
}
Given inverse_square() {
  return {[](double d) { return d_hat * d_hat / (d * d); },
          [](double d) { return -2 * d_hat * d_hat / (d * d * d); }};
}
Given decaying() {
  return {[](double d) { return std::exp(-3 * d / d_hat); },
          [](double d) { return -3 / d_hat * std::exp(-3 * d / d_hat); }};
}
Given root() {
  return {[](double d) { return std::sqrt(1 - d / d_hat); },
          [](double d) { return -0.5 / d_hat / std::sqrt(1 - d / d_hat); }};
}

ShapeTerms<double> at(const BarrierFunction& barrier, const Given& stiffness, double d, double k = 7) {
  GapPotential potential(barrier, stiffness);
  const KappaParts frozen{k, 0};
  ShapeTerms<double> out{};
  potential.eval(1, &d, &d_hat, &frozen, &out.b, &out.db, &out.d2b);
  return out;
}

/// Rounding of d_hat - s is what is left near d_hat.
double allowed(double u) { return 2e-14 + 1e-15 / (1 - u); }

TEST(GapPotential, OfAConstantIsTheBarrierItself) {
  for (const BarrierFunction& barrier : all_barriers()) {
    for (const double u : spaced_u(1e-6, 1e-4)) {
      const double d = u * d_hat;
      const ShapeTerms<double> found = at(barrier, constant(), d), b = barrier.eval(d, d_hat);
      ASSERT_GT(b.b, 0);
      EXPECT_LT(relative(found.b, 7 * b.b), 2 * allowed(u)) << label(barrier) << " u = " << u;
      EXPECT_LT(relative(found.db, 7 * b.db), 1e-15);
      EXPECT_LT(relative(found.d2b, 7 * b.d2b), 1e-15);
    }
  }
}

/// Shapes of several formulas, whose panels are cut where these meet.
TEST(GapPotential, OfAConstantIsTheBarrierItselfForJointsAnywhere) {
  for (const char* shape : {"minimax:3", "minimax:11.5", "minimax:40", "minimax_bounded:5"}) {
    for (const Argument argument : {Argument::gap, Argument::squared_gap}) {
      const BarrierFunction fn = barrier(shape, argument);
      ASSERT_GE(fn.shape.joints.size(), 2u);
      for (const double u : spaced_u(1e-6, 1e-4)) {
        const double d = u * d_hat;
        const double found = at(fn, constant(), d).b, exact = 7 * fn.eval(d, d_hat).b;
        ASSERT_GT(exact, 0);
        EXPECT_LT(relative(found, exact), 4 * allowed(u)) << label(fn) << " u = " << u;
      }
    }
  }
}

TEST(GapPotential, OfTheInverseSquareIsItsClosedForm) {
  for (const char* shape : {"cubic", "quadratic"}) {
    FoldedBarrier folded(barrier(shape));
    for (const double u : spaced_u(1e-9, 1e-4)) {
      const double d = u * d_hat;
      const KappaParts parts{0, 7 * d_hat * d_hat};
      ShapeTerms<double> exact{};
      folded.eval(1, &d, &d_hat, &parts, &exact.b, &exact.db, &exact.d2b);
      const ShapeTerms<double> found = at(barrier(shape), inverse_square(), d);
      ASSERT_GT(exact.b, 0);
      EXPECT_LT(relative(found.b, exact.b), allowed(u)) << shape << " u = " << u;
      EXPECT_LT(relative(found.db, exact.db), 1e-14);
      EXPECT_LT(relative(found.d2b, exact.d2b), 1e-14);
    }
  }
}

/// With b' = -2 (d_hat - s): exp(-3 s/d_hat) by parts, and half powers of d_hat - s.
TEST(GapPotential, MatchesClosedFormsInLongDouble) {
  const Real h = d_hat, a = 3 / h;
  for (const double u : spaced_u(1e-6, 1e-3)) {
    const Real d = u * d_hat, e = h - d;
    const Real by_parts = 14 * std::exp(-a * d) * (e / a - (1 - std::exp(-a * e)) / (a * a));
    if (u < 0.9) {  // beyond the closed form cancels
      EXPECT_LT(relative(at(barrier("quadratic"), decaying(), u * d_hat).b, static_cast<double>(by_parts)),
                allowed(u))
          << u;
    }
    const Real half_powers = 14 / std::sqrt(h) * std::pow(e, 2.5L) / 2.5L;
    EXPECT_LT(relative(at(barrier("quadratic"), root(), u * d_hat).b, static_cast<double>(half_powers)),
              allowed(u))
        << u;
  }
}

TEST(GapPotential, DerivativesMatchTheLadderOfDifferences) {
  const std::vector<Given> all = {inverse_square(), decaying(), root()};
  int n = 0;
  for (const BarrierFunction& barrier : all_barriers()) {
    for (const Given& stiffness : all) {
      for (const double u : {1e-5, 0.01, 0.3, 0.49, 0.51, 0.7, 0.98}) {
        const double d = u * d_hat;
        const ShapeTerms<double> here = at(barrier, stiffness, d);
        ASSERT_LT(here.db, 0);
        if (1e-6 * d * std::abs(here.db) < 1e-12 * here.b) continue;  // flat there: differences are rounding
        double first = INFINITY, second = INFINITY;
        for (int k = 2; k <= 6; ++k) {
          const double h = std::pow(10.0, -k) * std::min(d, d_hat - d), up = d + h, down = d - h;
          const ShapeTerms<double> plus = at(barrier, stiffness, up), minus = at(barrier, stiffness, down);
          first = std::min(first, relative((plus.b - minus.b) / (up - down), here.db));
          second = std::min(second, relative((plus.db - minus.db) / (up - down), here.d2b));
        }
        EXPECT_LT(first, 1e-6) << label(barrier) << " u = " << u;
        EXPECT_LT(second, 1e-6) << label(barrier) << " u = " << u;
        ++n;
      }
    }
  }
  EXPECT_GT(n, 200);
}

TEST(GapPotential, EndsAtDHat) {
  for (const double d : {d_hat, 2 * d_hat}) {
    const ShapeTerms<double> outside = at(barrier("cubic"), decaying(), d);
    EXPECT_TRUE(outside.b == 0 && outside.db == 0 && outside.d2b == 0);
  }
}

TEST(GapPotential, SaysWhatIsNoBarrier) {
  const KappaParts pairs[] = {{0, 1}, {7, 1}};
  const auto fault = [&pairs](const Given& stiffness) {
    return GapPotential(barrier("cubic"), stiffness).fault(pairs, d_hat);
  };
  for (const Given& fine : {inverse_square(), decaying(), root(), constant()}) EXPECT_EQ(fault(fine), "");
  const Given growing([](double d) { return std::pow(d / d_hat, 2); },
                      [](double d) { return 2 * d / (d_hat * d_hat); });
  EXPECT_EQ(fault(growing).rfind("a force that falls as the gap closes, at d = ", 0), 0U) << fault(growing);
  // wavy, and steeper than its waves
  const double waves = 3000 / d_hat;
  const Given wavy([=](double d) { return std::pow(d_hat / d, 2) * (1 + 1e-7 * std::sin(waves * d)); },
                   [=](double d) {
                     return -2 * d_hat * d_hat / (d * d * d) * (1 + 1e-7 * std::sin(waves * d)) +
                            std::pow(d_hat / d, 2) * 1e-7 * waves * std::cos(waves * d);
                   });
  EXPECT_EQ(fault(wavy).rfind("a potential whose integral is off by ", 0), 0U) << fault(wavy);
}

}  // namespace
}  // namespace bb::test::gap_potential_test
