// Derivatives and values of every shape: finite differences over a ladder of steps, and long double
// evaluation of formulas written here once more, in the unexpanded form.
#include <gtest/gtest.h>

#include <functional>
#include <map>

#include "tests/barriers/barrier_cases.hpp"
#include "tests/barriers/minimax_terms.hpp"

namespace bb::test::shapes_test {
namespace {

constexpr double d_hat = 2.5e-3;

/// Smallest relative error of the central differences of b and b' over h = 10^-k min(d, d_hat - d), k = 1..8.
std::pair<double, double> ladder_errors(const BarrierFunction& fn, double d) {
  const ShapeTerms<double> at = fn.eval(d, d_hat);
  double first = INFINITY, second = INFINITY;
  for (int k = 1; k <= 8; ++k) {
    const double h = std::pow(10.0, -k) * std::min(d, d_hat - d);
    const double up = d + h, down = d - h;  // as rounded, so that the step taken is the step divided by
    const ShapeTerms<double> plus = fn.eval(up, d_hat), minus = fn.eval(down, d_hat);
    first = std::min(first, relative((plus.b - minus.b) / (up - down), at.db));
    second = std::min(second, relative((plus.db - minus.db) / (up - down), at.d2b));
  }
  return {first, second};
}

TEST(Shapes, DerivativesMatchTheLadderOfDifferencesTowardsBothEnds) {
  for (const BarrierFunction& fn : all_barriers()) {
    int compared = 0;
    for (const double u : spaced_u(1e-8, 5e-6)) {
      const double d = u * d_hat, reach = std::min(d, d_hat - d);
      const ShapeTerms<double> at = fn.eval(d, d_hat);
      const auto [first, second] = ladder_errors(fn, d);
      ASSERT_NE(at.db, 0) << label(fn) << " u = " << u;
      // no difference sees a change far below the rounding of the value (polynomials of d^2 near contact),
      // and the relative error of b'' means nothing where it changes sign
      if (std::abs(at.db) * reach > 1e-8 * at.b) {
        EXPECT_LT(first, 1e-6) << label(fn) << " u = " << u;
        ++compared;
      }
      if (std::abs(at.d2b) * reach > 1e-2 * std::abs(at.db)) {
        EXPECT_LT(second, 1e-6) << label(fn) << " u = " << u;
        ++compared;
      }
    }
    EXPECT_GT(compared, 50) << label(fn);
  }
}

using Real = long double;
struct Reference {
  std::function<Real(Real, Real)> b, db, d2b;
};

/// Of the exponent 7.
Reference minimax_reference(bool infinite_at_zero) {
  const auto terms = [=](Real d, Real dh) { return minimax_terms(7, d / dh, infinite_at_zero); };
  return {[=](Real d, Real dh) { return dh * dh * terms(d, dh).b; },
          [=](Real d, Real dh) { return dh * terms(d, dh).db; },
          [=](Real d, Real dh) { return terms(d, dh).d2b; }};
}

/// The formulas as the literature writes them; long double carries 64 bits, so that their cancellation near
/// d_hat stays below what is asserted.
std::map<std::string, Reference> references() {
  const auto ln = [](Real d, Real dh) { return std::log(d / dh); };
  std::map<std::string, Reference> r;
  r["log"] = {[=](Real d, Real dh) { return -(d - dh) * (d - dh) * ln(d, dh); },
              [=](Real d, Real dh) { return (dh - d) * (2 * ln(d, dh) - dh / d + 1); },
              [=](Real d, Real dh) { return (dh / d + 2) * (dh / d) - 2 * ln(d, dh) - 3; }};
  r["log_squared"] = {[=](Real d, Real dh) { return (d - dh) * (d - dh) * ln(d, dh) * ln(d, dh); },
                      [=](Real d, Real dh) { return 2 * (d - dh) * ln(d, dh) * (ln(d, dh) + (d - dh) / d); },
                      [=](Real d, Real dh) {
                        const Real q = (d - dh) / d;
                        return 2 * ln(d, dh) * ln(d, dh) + 8 * q * ln(d, dh) + 2 * q * q * (1 - ln(d, dh));
                      }};
  r["quadratic"] = {[](Real d, Real dh) { return (dh - d) * (dh - d); },
                    [](Real d, Real dh) { return 2 * (d - dh); }, [](Real, Real) { return Real(2); }};
  r["cubic"] = {[](Real d, Real dh) { return -2 * (d - dh) * (d - dh) * (d - dh) / (3 * dh); },
                [](Real d, Real dh) { return -2 * (d - dh) * (d - dh) / dh; },
                [](Real d, Real dh) { return 4 * (1 - d / dh); }};
  r["two_stage"] = {[](Real d, Real dh) {
                      return d >= dh / 2 ? (dh - d) * (dh - d)
                                         : dh * dh / 4 - dh * dh / 2 * std::log(2 * d / dh);
                    },
                    [](Real d, Real dh) { return d >= dh / 2 ? 2 * (d - dh) : -dh * dh / (2 * d); },
                    [](Real d, Real dh) { return d >= dh / 2 ? Real(2) : dh * dh / (2 * d * d); }};
  const Real a = 6;
  r["exponential"] = {[=](Real d, Real dh) {
                        const Real t = a * (1 - d / dh);
                        return dh * dh * (std::expm1(t) - t - t * t / 2) / (a * std::exp(a));
                      },
                      [=](Real d, Real dh) {
                        const Real t = a * (1 - d / dh);
                        return -dh * (std::expm1(t) - t) / std::exp(a);
                      },
                      [=](Real d, Real dh) { return a * std::expm1(a * (1 - d / dh)) / std::exp(a); }};
  r["minimax_bounded"] = minimax_reference(false), r["minimax"] = minimax_reference(true);
  return r;
}

TEST(Shapes, TermsMatchLongDoubleFormulas) {
  for (const auto& [name, reference] : references()) {
    const BarrierFunction fn = barrier(name.c_str());
    for (const double u : spaced_u(1e-100, 1e-3, 2)) {
      const double d = u * d_hat;
      const ShapeTerms<double> at = fn.eval(d, d_hat);
      EXPECT_LT(relative(at.b, static_cast<double>(reference.b(d, d_hat))), 1e-14) << name << " u = " << u;
      EXPECT_LT(relative(at.db, static_cast<double>(reference.db(d, d_hat))), 1e-14) << name << " u = " << u;
      EXPECT_LT(relative(at.d2b, static_cast<double>(reference.d2b(d, d_hat))), 1e-12)
          << name << " u = " << u;
    }
  }
}

/// Leading terms for e = 1 - d/d_hat -> 0 of the shapes that are not polynomials:
///   log: e^3, 3 e^2, 6 e;   log_squared: e^4, 4 e^3, 12 e^2; the next term is smaller by a factor of order
///   e.
TEST(Shapes, KeepFullPrecisionUpToTheLastGapBelowDHat) {
  for (const double e : {1e-9, 1e-12, 1e-15}) {
    const double d = d_hat * (1 - e), exact = (d_hat - d) / d_hat;
    const ShapeTerms<double> log = barrier("log").eval(d, d_hat);
    const ShapeTerms<double> square = barrier("log_squared").eval(d, d_hat);

    EXPECT_LT(relative(log.b, d_hat * d_hat * std::pow(exact, 3)), 1e-8);
    EXPECT_LT(relative(log.db, -3 * d_hat * exact * exact), 1e-8);
    EXPECT_LT(relative(log.d2b, 6 * exact), 1e-8);
    EXPECT_LT(relative(square.b, d_hat * d_hat * std::pow(exact, 4)), 1e-8);
    EXPECT_LT(relative(square.db, -4 * d_hat * std::pow(exact, 3)), 1e-8);
    EXPECT_LT(relative(square.d2b, 12 * exact * exact), 1e-8);
  }
}

/// b, b', b'' at d = 1, d_hat = 2 and (cubic on the square) worked out by hand; l = ln 2.
TEST(Shapes, MatchHandComputedValues) {
  const double l = 0.69314718055994530942;
  const auto expect = [](const BarrierFunction& fn, double d, double width, double b, double db, double d2b) {
    const ShapeTerms<double> at = fn.eval(d, width);
    EXPECT_DOUBLE_EQ(at.b, b) << label(fn);
    EXPECT_DOUBLE_EQ(at.db, db) << label(fn);
    EXPECT_DOUBLE_EQ(at.d2b, d2b) << label(fn);
  };
  expect(barrier("log"), 1, 2, l, -2 * l - 1, 2 * l + 5);
  expect(barrier("log_squared"), 1, 2, l * l, -2 * l * l - 2 * l, 2 * l * l + 10 * l + 2);
  expect(barrier("quadratic"), 1, 2, 1, -2, 2);
  expect(barrier("cubic"), 1, 2, 1.0 / 3, -1, 2);
  expect(barrier("two_stage"), 1, 2, 1, -2, 2);
  expect(barrier("two_stage"), 0.5, 2, 1 + 2 * l, -4, 8);
  // f = 2/3 (4 - D)^3/4 at D = 1: f = 9/2, f' = -9/2, f'' = 3
  expect(barrier("cubic", Argument::squared_gap), 1, 2, 9.0 / 8, -9.0 / 4, 3.0 / 4);
  // f = (D - 4)^2 at D = 1: f = 9, f' = -6, f'' = 2
  expect(barrier("quadratic", Argument::squared_gap), 1, 2, 9.0 / 4, -3, -1);
}

}  // namespace
}  // namespace bb::test::shapes_test
