// From a saddle a step goes on along negative curvature: what is required of that, with a number on either side.
#include <gtest/gtest.h>

#include "tests/newton/scripted_system.hpp"

namespace bb::escape_decisions_test {
namespace {

using test::Change;
using test::ScriptedIteration;
using test::ScriptedStep;

constexpr double tol = ScriptedStep::tolerance;

/// An iterate that is small enough for an end, and a saddle; what comes behind an escape is far from any end.
std::vector<ScriptedIteration> saddle(double curvature, std::function<Change(double)> change,
                                      double slope = 0, double bound = 1) {
  ScriptedIteration at{.dx = 1e-3 * tol, .slope = -1e-6, .end = EndProof::saddle};
  at.escape_slope = slope, at.escape_curvature = curvature, at.escape_bound = bound;
  at.escape_change = std::move(change);
  return {at, {.dx = 1, .slope = -1}};
}

/// The alpha of the escape in the first iteration; 0: there was none.
double escaped(const std::vector<ScriptedIteration>& script, SaddleRule rule = SaddleRule::escape) {
  const ScriptedStep step(script, rule, 0.1, 2);
  EXPECT_FALSE(step.iterations.empty());
  return step.iterations[0].escapes > 0 ? step.iterations[0].alpha : 0;
}

std::function<Change(double)> at_one(double change, double magnitude = 1e-3) {
  return [=](double alpha) -> Change {
    return alpha == 1 ? EnergyChange{change, magnitude} : EnergyChange{1, magnitude};
  };
}

/// Armijo's share, 0.1, of slope and half the curvature.
TEST(EscapeDecisions, EHasToFallByAPartOfWhatIsModelled) {
  EXPECT_EQ(escaped(saddle(-2, at_one(-0.101))), 1);
  EXPECT_EQ(escaped(saddle(-2, at_one(-0.099))), 0);
  EXPECT_EQ(escaped(saddle(-2, at_one(-0.201), -1)), 1);
  EXPECT_EQ(escaped(saddle(-2, at_one(-0.199), -1)), 0);
  // a slope upwards within rounding promises nothing and takes nothing away
  EXPECT_EQ(escaped(saddle(-2, at_one(-0.101), 1e3)), 1);
  EXPECT_EQ(escaped(saddle(-2, at_one(-0.099), 1e3)), 0);
}

TEST(EscapeDecisions, ShorterStepsAreModelledWithTheSquareOfTheirLength) {
  const auto at_half = [](double change) {
    return [=](double alpha) -> Change { return EnergyChange{alpha == 0.5 ? change : 1, 1e-3}; };
  };
  EXPECT_EQ(escaped(saddle(-2, at_half(-0.0251))), 0.5);
  EXPECT_EQ(escaped(saddle(-2, at_half(-0.0249))), 0);
  EXPECT_EQ(escaped(saddle(-2, at_half(-0.0751), -1)), 0.5);
  EXPECT_EQ(escaped(saddle(-2, at_half(-0.0749), -1)), 0);
}

/// A direction that is not curved down leads nowhere, however far E falls along it.
TEST(EscapeDecisions, AreNotTriedWithoutNegativeCurvature) {
  for (const double curvature : {0.0, 1e-30, 1.0, std::nan("")}) {
    const ScriptedStep step(saddle(curvature, at_one(-1e6), -1), SaddleRule::escape, 0.1, 2);
    EXPECT_EQ(step.iterations[0].escapes, 0) << curvature;
    EXPECT_EQ(step.report.status, StepStatus::converged) << curvature;
    EXPECT_EQ(step.report.end_proof, EndProof::saddle) << curvature;
    EXPECT_EQ(step.system.aimed.size(), 1U);
  }
  EXPECT_EQ(escaped(saddle(-1e-30, at_one(-1e6))), 1);
}

/// The search that follows goes along Newton's direction, and not along that of the escape, d_hat long.
TEST(EscapeDecisions, LeaveNewtonsDirectionWhereTheyFail) {
  for (const double curvature : {0.0, -2.0}) {
    const ScriptedStep step(saddle(curvature, at_one(-0.05)), SaddleRule::escape, 0.1, 2);
    ASSERT_EQ(step.iterations[0].escapes, 0);
    EXPECT_NE(step.iterations[0].energy_change_J.value, -0.05)
        << "refused as an escape, taken as Newton's step";
    EXPECT_EQ(step.report.end_proof, EndProof::saddle);
    EXPECT_EQ(step.report.newton_iterations, 1);
  }
}

TEST(EscapeDecisions, AFallWithinRoundingIsNone) {
  constexpr double noise = 64 * std::numeric_limits<double>::epsilon();
  EXPECT_EQ(escaped(saddle(-1e-16, at_one(-0.99 * noise, 1))), 0);
  EXPECT_EQ(escaped(saddle(-1e-16, at_one(-1.01 * noise, 1))), 1);
}

TEST(EscapeDecisions, KeepToTheBoundAndToFeasibleStatesDownToTheTolerance) {
  std::vector<double> asked;
  const auto never = [&asked](double alpha) -> Change {
    asked.push_back(alpha);
    return std::nullopt;
  };
  EXPECT_EQ(escaped(saddle(-1, never, 0, 0.5)), 0);
  ASSERT_GE(asked.size(), 2U);
  EXPECT_EQ(asked[0], 0.4);  // cap_fraction of the bound
  EXPECT_EQ(asked[1], 0.2);
  const auto next = std::find(asked.begin() + 1, asked.end(), 0.4);  // of the search that follows
  EXPECT_GT(next[-1] * 0.01, tol);                                   // d_hat is 0.01 m
  EXPECT_LE(next[-1] * 0.01 / 2, tol);
  asked.clear();
  EXPECT_EQ(escaped(saddle(-1, never)), 0);
  EXPECT_EQ(asked[0], 1);
}

TEST(EscapeDecisions, AreAsLongAsTheWidestActivationDistance) {
  const ScriptedStep step(saddle(-1, at_one(-1)), SaddleRule::escape, 0.1, 2);
  ASSERT_EQ(step.system.aimed.size(), 1U);
  EXPECT_EQ(step.system.aimed[0], 0.01);
}

TEST(EscapeDecisions, AreTakenUnderTheRuleEscapeAlone) {
  const auto script = saddle(-2, at_one(-1));
  EXPECT_EQ(escaped(script), 1);
  for (const SaddleRule rule : {SaddleRule::report, SaddleRule::ignore}) {
    const ScriptedStep step(script, rule);
    EXPECT_EQ(step.report.status, StepStatus::converged);
    EXPECT_EQ(step.report.newton_iterations, 1);
    EXPECT_EQ(step.report.escapes, 0);
    EXPECT_EQ(step.system.checks, rule == SaddleRule::report ? 1 : 0);
    EXPECT_EQ(step.report.end_proof, rule == SaddleRule::report ? EndProof::saddle : EndProof::not_checked);
    EXPECT_EQ(step.report.saddle_curvature_N_per_m.finite(), rule == SaddleRule::report);
  }
  // a minimum is not left
  auto minimum = script;
  minimum[0].end = EndProof::factor;
  EXPECT_EQ(escaped(minimum), 0);
}

/// Away from a cusp there is no curvature to require: E has to fall by a part of what its slope promises, and beyond rounding.
TEST(EscapeDecisions, LeaveACuspWhateverTheCurvature) {
  for (const double curvature : {-2.0, 0.0, 5.0}) {
    auto script = saddle(curvature, at_one(-0.05));
    script[0].end = EndProof::cusp;
    EXPECT_EQ(escaped(script), 1) << curvature;
    const ScriptedStep told(script, SaddleRule::report);
    EXPECT_EQ(told.report.end_proof, EndProof::cusp);
    EXPECT_EQ(told.report.escapes, 0);
    EXPECT_FALSE(told.report.saddle_curvature_N_per_m.finite());
  }
  auto level = saddle(0, at_one(-1e-18));
  level[0].end = EndProof::cusp;
  EXPECT_EQ(escaped(level), 0);
  auto promised = saddle(0, at_one(-0.09), -1);  // a tenth of the slope of 1 is requested
  promised[0].end = EndProof::cusp;
  EXPECT_EQ(escaped(promised), 0);
}

TEST(EscapeDecisions, AreTakenTenTimesAStepAndThenItEndsInASaddle) {
  auto script = saddle(-2, at_one(-1));
  script.pop_back();
  const ScriptedStep step(script);
  EXPECT_EQ(step.report.status, StepStatus::converged);
  EXPECT_EQ(step.report.end_proof, EndProof::saddle);
  EXPECT_EQ(step.report.escapes, 10);
  EXPECT_EQ(step.report.newton_iterations, 11);
}

/// Of all saddles that the step met, whichever came last; what is no saddle has no part in it.
TEST(EscapeDecisions, LeaveTheSmallestCurvatureOfAllSaddlesInTheRecord) {
  for (const std::vector<double>& met :
       {std::vector<double>{-3, -1}, {-1, -3}, {-2, -3, -1}, {-3}, {-0.5, -3, -2, -1}}) {
    std::vector<ScriptedIteration> script;
    for (const double curvature : met) {
      script.push_back(saddle(-2, at_one(-1))[0]);
      script.back().curvature = curvature;
    }
    script.push_back({.dx = 1e-3 * tol, .slope = -1e-6});
    const ScriptedStep step(script);
    ASSERT_EQ(step.report.status, StepStatus::converged);
    ASSERT_EQ(step.report.escapes, static_cast<int>(met.size()));
    EXPECT_EQ(step.report.end_proof, EndProof::factor);  // of the end, which is none
    EXPECT_EQ(step.report.saddle_curvature_N_per_m.value, -3);
  }
  const ScriptedStep none({{.dx = 1e-3 * tol, .slope = -1e-6}});
  ASSERT_EQ(none.report.status, StepStatus::converged);
  EXPECT_GT(none.system.checks, 0);
  EXPECT_FALSE(none.report.saddle_curvature_N_per_m.finite());
}

/// Behind an escape nothing is known of the rate: one short direction alone proves no end.
TEST(EscapeDecisions, LeaveNoRateOfConvergenceBehind) {
  auto script = saddle(-2, at_one(-1));
  script[1] = {.dx = tol / 9.1, .slope = -1e-6};
  script.push_back({.dx = 1});
  EXPECT_EQ(ScriptedStep(script).report.newton_iterations, 2);
  script[1].dx = tol / 8.9;
  EXPECT_NE(ScriptedStep(script).report.newton_iterations, 2);
}

}  // namespace
}  // namespace bb::escape_decisions_test
