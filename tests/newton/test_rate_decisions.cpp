// From which directions a step reads how fast it converges: from whole ones of this step, one right after the other.
// What follows anything else shows nothing of the rate, and is judged by the rate that counts as unknown.
#include <gtest/gtest.h>

#include <string>

#include "tests/newton/scripted_system.hpp"

namespace bb::rate_decisions_test {
namespace {

using test::Change;
using test::ScriptedIteration;
using test::ScriptedStep;

constexpr double tol = ScriptedStep::tolerance;

/// An iterate in a saddle, whose direction may be small enough for an end; an escape from it lowers E.
ScriptedIteration saddle(double dx) {
  ScriptedIteration out{.dx = dx, .slope = -1e-6, .end = EndProof::saddle};
  out.escape_curvature = -2;
  out.escape_change = [](double) -> Change { return EnergyChange{-1, 1e-3}; };
  return out;
}

ScriptedIteration halved(double dx) {
  ScriptedIteration out{.dx = dx};
  out.change = [](double alpha) -> Change { return EnergyChange{alpha < 1 ? -alpha : 1, 1e-3}; };
  return out;
}

/// The reports of all iterations; the last one of a script is repeated.
std::vector<IterationReport> reported(const std::vector<ScriptedIteration>& script) {
  return ScriptedStep(script, SaddleRule::escape, 0.1, static_cast<int>(script.size())).iterations;
}

/// What the second of two iterations reports of the rate; empty: it knows it.
std::string rate_after(const ScriptedIteration& first) {
  const std::vector<IterationReport> all = reported({first, {.dx = 1}});
  EXPECT_EQ(all.size(), 2U);
  if (all.size() < 2) return "the step ended";
  EXPECT_GT(all[0].alpha, 0);
  return all[1].contraction.finite() ? "" : all[1].contraction.status;
}

TEST(RateDecisions, OnlyAWholeDirectionOfNewtonIsComparedWithTheNext) {
  EXPECT_EQ(rate_after({.dx = 10}), "");
  EXPECT_EQ(rate_after({.dx = 10, .bound = 0.5}), "shortened_step");
  EXPECT_EQ(rate_after(halved(10)), "shortened_step");
  EXPECT_EQ(rate_after(saddle(1e-3 * tol)), "shortened_step");
  ScriptedIteration round{.dx = 10, .bound = 0.1};
  round.corrected_bound = 1;
  EXPECT_EQ(rate_after(round), "shortened_step");  // another direction was taken, though the whole of it
  EXPECT_EQ(reported({{.dx = 10}})[0].contraction.status, std::string("first_iteration"));
}

/// The direction at a saddle is as small as at an end. Compared with it, the first one on the way to the minimum looks
/// like a divergence, and the step would go on after its end.
TEST(RateDecisions, TheDirectionBehindAnEscapeIsNotComparedWithTheOneAtTheSaddle) {
  for (const auto& [dx, iterations] : {std::pair{tol / 9.1, 3}, {tol / 8.9, 0}}) {
    const std::vector<ScriptedIteration> script{
        {.dx = 100 * tol}, saddle(1e-3 * tol), {.dx = dx, .slope = -1e-6}, {.dx = 1}};
    const ScriptedStep step(script);
    ASSERT_EQ(step.report.escapes, 1);
    ASSERT_TRUE(step.iterations[1].contraction.finite());  // the one before the saddle was taken whole
    EXPECT_STREQ(step.iterations[2].contraction.status, "shortened_step");
    EXPECT_NEAR(step.iterations[2].error_estimate_m.value, 9 * dx, 1e-12);  // 0.9 / (1 - 0.9)
    EXPECT_EQ(step.report.status == StepStatus::converged ? step.report.newton_iterations : 0, iterations);
  }
}

/// Two whole directions later the rate is known again, with an unknown one before it: 0.81 at least.
TEST(RateDecisions, RatesFromBeforeAnEscapeBoundNoLaterOnes) {
  const std::vector<IterationReport> all =
      reported({{.dx = 1000 * tol}, {.dx = tol}, saddle(1e-3 * tol), {.dx = 1}, {.dx = 0.2}, {.dx = 0.02}});
  ASSERT_EQ(all.size(), 6U);
  ASSERT_EQ(all[2].escapes, 1);
  EXPECT_FALSE(all[3].contraction.finite());
  EXPECT_DOUBLE_EQ(all[4].contraction.value, 0.9 * 0.9);
  EXPECT_DOUBLE_EQ(all[5].contraction.value, 0.1);  // above 0.2^2
}

TEST(RateDecisions, ACurvatureCorrectionIsTakenWhereItGoesMoreThanTwiceAsFar) {
  for (const double straight : {0.49, 0.51}) {
    ScriptedIteration held{.dx = 10, .bound = straight};
    held.corrected_bound = 1;
    const ScriptedStep step({held}, SaddleRule::ignore, 0.1, 1);
    ASSERT_EQ(step.iterations.size(), 1U);
    const bool taken = straight < 0.5;
    EXPECT_EQ(step.iterations[0].detours, taken ? 1 : 0);
    EXPECT_DOUBLE_EQ(step.iterations[0].alpha, taken ? 1 : 0.8 * straight);  // cap_fraction of the bound
    EXPECT_EQ(step.system.tried.size(), 1U);
  }
}

/// No curvature correction is made in the last iteration of a step, and none while a vertex is short of its pose.
TEST(RateDecisions, ACurvatureCorrectionIsForDirectionsThatAreLongAndOnTheirPose) {
  const auto detours = [](double dx, bool at_target) {
    ScriptedIteration held{.dx = dx, .bound = 0.1};
    held.corrected_bound = 1;
    held.at_target = at_target;
    const ScriptedStep step({held}, SaddleRule::ignore, 0.1, 1);
    return step.iterations.at(0).detours;
  };
  EXPECT_EQ(detours(10, true), 1);
  EXPECT_EQ(detours(10, false), 0);
  EXPECT_EQ(detours(tol / 10, true), 0);
  EXPECT_EQ(detours(tol / 8, true), 1);  // its estimated error is above the tolerance
}

}  // namespace
}  // namespace bb::rate_decisions_test
