// When a step is over: every condition of its end with a number on either side of it.
#include <gtest/gtest.h>

#include "tests/newton/scripted_system.hpp"

namespace bb::end_decisions_test {
namespace {

using test::ScriptedIteration;
using test::ScriptedStep;

constexpr double tol = ScriptedStep::tolerance;

/// Directions that shrink fast, then the last one.
std::vector<ScriptedIteration> falling(const ScriptedIteration& last) {
  ScriptedIteration first, second;
  first.dx = 1e4 * last.dx, second.dx = 1e2 * last.dx;
  return {first, second, last};
}

/// Two directions that are far from an end, then the last one.
std::vector<ScriptedIteration> far_before(const ScriptedIteration& last) {
  return {{.dx = 1e4 * tol}, {.dx = 1e2 * tol}, last};
}

/// Iterations until the step ended; 0: it did not converge.
int ended_after(const std::vector<ScriptedIteration>& script) {
  const ScriptedStep step(script);
  return step.report.status == StepStatus::converged ? step.report.newton_iterations : 0;
}

TEST(EndDecisions, AResidualOfTheSolveCountsInTheEstimatedError) {
  // the estimate is dx r / (1 - r): below the tolerance up to r = 1/11 for ten tolerances
  for (const double r : {0.05, 0.09, 0.0909}) {
    ScriptedIteration last{.dx = 10 * tol, .residual = r};
    EXPECT_EQ(ended_after(falling(last)), 3) << r;
  }
  for (const double r : {0.0910, 0.2, 0.9}) {
    ScriptedIteration last{.dx = 10 * tol, .residual = r};
    std::vector<ScriptedIteration> script = falling(last);
    EXPECT_NE(ended_after(script), 3) << r;
  }
}

TEST(EndDecisions, RoundingOfADirectionIsNoErrorBelowTheToleranceAlone) {
  EXPECT_EQ(ended_after(far_before({.dx = 1e-3 * tol, .rounding = 0.99 * tol})), 3);
  EXPECT_EQ(ended_after(far_before({.dx = 1e-3 * tol, .rounding = 1.01 * tol})), 0);
}

TEST(EndDecisions, TheToleranceIsThatOfTheEstimateAndNotOfTheDirection) {
  // q = 0.01 and at least the square of the ratio before: the estimate is dx / 99
  EXPECT_EQ(ended_after(falling({.dx = 98 * tol})), 3);
  const ScriptedStep more(falling({.dx = 100 * tol}));
  EXPECT_GT(more.report.newton_iterations, 3);
  EXPECT_DOUBLE_EQ(ScriptedStep(falling({.dx = 98 * tol})).report.end_error_tolerances.value, 98.0 / 99);
}

/// A last direction that its bound cuts leaves the rest of itself: 0.8 of the bound is taken.
TEST(EndDecisions, TheRestOfALastDirectionCountsInTheError) {
  for (const double bound : {1.0, 0.5, 0.25}) {
    const double taken = bound < 1 ? 0.8 * bound : 1;
    const ScriptedStep step(falling({.dx = 0.5 * tol, .bound = bound}));
    ASSERT_EQ(step.report.status, StepStatus::converged);
    ASSERT_EQ(step.report.newton_iterations, 3);
    EXPECT_DOUBLE_EQ(step.report.end_error_tolerances.value, 0.5 / 99 + 0.5 * (1 - taken)) << bound;
  }
}

TEST(EndDecisions, AVertexShortOfItsPoseIsNoEnd) {
  ScriptedIteration last{.dx = 1e-3 * tol};
  EXPECT_EQ(ended_after(far_before(last)), 3);
  last.at_target = false;
  EXPECT_EQ(ended_after(far_before(last)), 0);
}

TEST(EndDecisions, PartOfADirectionEndsAStepOnlyWhereAllOfItIsBelowTheTolerance) {
  ScriptedIteration last{.dx = 0.99 * tol, .bound = 0.5};
  EXPECT_EQ(ended_after(falling(last)), 3);
  last.dx = 1.01 * tol;
  const ScriptedStep step(falling(last));
  EXPECT_NE(step.report.newton_iterations, 3);
  EXPECT_EQ(step.iterations[2].alpha, 0.4);  // cap_fraction of the bound
}

/// Without a known rate E has to fall as modelled, by a quarter more or less.
TEST(EndDecisions, WithoutAKnownRateEHasToChangeAsModelled) {
  for (const auto& [part, ends] : {std::pair{0.76, true}, {0.74, false}, {1.24, true}, {1.26, false}}) {
    ScriptedIteration only{.dx = 0.1 * tol, .slope = -1e-3};
    only.change = [part = part](double) { return EnergyChange{part * -0.5e-3, 1}; };
    const ScriptedStep step({only, {.dx = 1e4 * tol}});
    EXPECT_EQ(step.report.newton_iterations == 1, ends) << part;
  }
  // by noise it has not changed
  ScriptedIteration noise{.dx = 0.1 * tol, .slope = -1e-17};
  noise.change = [](double) { return EnergyChange{1e-15, 1}; };
  EXPECT_EQ(ended_after({noise}), 1);
}

/// 0.9 is what an unknown rate counts as.
TEST(EndDecisions, AnUnknownRateIsNineTenths) {
  EXPECT_EQ(ended_after({{.dx = tol / 9.1}}), 1);
  EXPECT_NE(ended_after({{.dx = tol / 8.9}}), 1);
}

TEST(EndDecisions, TenStepsInARowWithoutProgressEndIt) {
  const auto status = [](int small, double bound) {
    std::vector<ScriptedIteration> script(static_cast<std::size_t>(small), {.dx = 1, .bound = bound});
    script.push_back({.dx = 1});
    const ScriptedStep step(script, SaddleRule::ignore, 0.1, 30);
    return std::pair(step.report.status, step.report.newton_iterations);
  };
  EXPECT_EQ(status(10, 1e-8), std::pair(StepStatus::step_collapse, 10));
  EXPECT_EQ(status(9, 1e-8).first, StepStatus::iteration_cap);
  EXPECT_EQ(status(10, 1.26e-8).first, StepStatus::iteration_cap);  // 0.8 of it is above 1e-8
  EXPECT_EQ(status(10, 1.24e-8).first, StepStatus::step_collapse);
  ScriptedIteration pinned{.dx = 1, .bound = 1e-9, .at_target = false};
  ScriptedIteration stopped{.dx = 1, .bound = 0};
  EXPECT_EQ(ScriptedStep({pinned}).report.status, StepStatus::pin_infeasible);
  EXPECT_EQ(ScriptedStep({stopped}).report.status, StepStatus::step_collapse);
}

TEST(EndDecisions, NoDescentAtAnyLengthFailsAtOnceUnlessTheBoundHeldIt) {
  ScriptedIteration uphill{.dx = 1};
  uphill.change = [](double) { return EnergyChange{1, 1}; };
  const ScriptedStep failed({uphill});
  EXPECT_EQ(failed.report.status, StepStatus::line_search_failed);
  EXPECT_EQ(failed.report.newton_iterations, 1);
  uphill.bound = 0.99e-8;
  EXPECT_EQ(ScriptedStep({uphill}).report.status, StepStatus::step_collapse);
}

TEST(EndDecisions, ArmijosShareOfTheSlopeIsOnEitherSideOfAcceptance) {
  for (const auto& [fall, trials] : {std::pair{0.1001, 1}, {0.0999, 2}}) {
    ScriptedIteration one{.dx = 1, .slope = -1};  // 2 decrements are 1
    one.change = [fall = fall](double alpha) { return EnergyChange{-fall * (alpha < 1 ? 1 : alpha), 1e-3}; };
    const ScriptedStep step({one}, SaddleRule::ignore, 0.1, 1);
    EXPECT_EQ(step.iterations[0].line_search_trials, trials) << fall;
    EXPECT_FALSE(step.iterations[0].rounding_accepts);
  }
}

TEST(EndDecisions, InfeasibleTrialsAreHalvedAndBoundsAreKept) {
  ScriptedIteration one{.dx = 1, .bound = 0.5};
  one.change = [](double alpha) {
    return alpha > 0.15 ? std::nullopt : std::optional<EnergyChange>({-alpha, 1e-3});
  };
  const ScriptedStep step({one}, SaddleRule::ignore, 0.1, 1);
  EXPECT_EQ(step.system.tried, (std::vector<double>{0.4, 0.2, 0.1}));
  EXPECT_EQ(step.iterations[0].alpha, 0.1);
  EXPECT_EQ(step.system.accepted, 1);
  EXPECT_TRUE(step.system.feasible_asked.empty());
}

/// A pin that moves does work: until it is where it has to be E may grow, and no fall is required.
TEST(EndDecisions, ShortOfAPoseFeasibilityAloneIsAsked) {
  ScriptedIteration one{.dx = 1, .bound = 0.5};
  one.at_target = false;
  one.change = [](double alpha) {
    return alpha > 0.15 ? std::nullopt : std::optional<EnergyChange>({alpha, 1e-3});
  };
  const ScriptedStep step({one}, SaddleRule::ignore, 0.1, 1);
  EXPECT_EQ(step.system.feasible_asked, (std::vector<double>{0.4, 0.2, 0.1}));
  EXPECT_TRUE(step.system.tried.empty());
  EXPECT_EQ(step.iterations[0].alpha, 0.1);
  EXPECT_EQ(step.system.accepted, 1);
  EXPECT_STREQ(step.iterations[0].energy_change_J.status, no_energies_compared);
}

/// While a vertex is short of its pose any feasible state is taken, uphill too.
TEST(EndDecisions, WithoutAnEnergyTestWhileAVertexIsShortOfItsPose) {
  ScriptedIteration one{.dx = 1};
  one.change = [](double) { return EnergyChange{5, 1}; };
  one.at_target = false;
  const ScriptedStep step({one}, SaddleRule::ignore, 0.1, 1);
  EXPECT_EQ(step.system.accepted, 1);
  EXPECT_EQ(step.iterations[0].alpha, 1);
  EXPECT_FALSE(step.iterations[0].rounding_accepts);
}

TEST(EndDecisions, ADirectionThatDoesNotDescendIsAFailureOnlyWhereItHasToAndIsNoEnd) {
  ScriptedIteration level{.dx = 1, .slope = 0};
  EXPECT_EQ(ScriptedStep({level}).report.status, StepStatus::not_descent);
  level.at_target = false;
  level.change = [](double) { return EnergyChange{0, 1}; };
  EXPECT_EQ(ScriptedStep({level}, SaddleRule::ignore, 0.1, 3).report.status, StepStatus::iteration_cap);
  level.at_target = true;
  level.dx = 1e-3 * tol;  // small: nothing is left to descend
  EXPECT_EQ(ended_after({level}), 1);
}

}  // namespace
}  // namespace bb::end_decisions_test
