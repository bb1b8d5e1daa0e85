// When the matrix has the secant of a term, and how much of it: what is asked of that, with a number on either side.
#include <gtest/gtest.h>

#include "tests/newton/scripted_system.hpp"

namespace bb::secant_decisions_test {
namespace {

using test::Change;
using test::ScriptedIteration;
using test::ScriptedStep;

ScriptedIteration whole() { return {.dx = 1, .slope = -1}; }
/// E rises along dx, and falls along its half.
ScriptedIteration shortened() {
  ScriptedIteration out = whole();
  out.change = [](double alpha) -> Change { return EnergyChange{alpha > 0.5 ? 1 : -alpha, 1e-3}; };
  return out;
}
ScriptedIteration small() { return {.dx = ScriptedStep::tolerance / 100, .slope = -1e-6}; }

ScriptedStep taken(const std::vector<ScriptedIteration>& script, int n, bool has_secant = true) {
  return ScriptedStep(script, SaddleRule::escape, 0.1, n, {.has_secant = has_secant});
}
/// Share of the secant in each of n iterations.
std::vector<double> shares(const std::vector<ScriptedIteration>& script, int n, bool has_secant = true) {
  return taken(script, n, has_secant).system.secants;
}
using Shares = std::vector<double>;

TEST(SecantDecisions, AStepThatWasShortenedAsksForAllOfItAndWholeOnesForEverLess) {
  EXPECT_EQ(shares({whole()}, 3), (Shares{0, 0, 0}));
  EXPECT_EQ(shares({whole(), shortened(), whole()}, 7), (Shares{0, 0, 1, 0.25, 0.0625, 0, 0}));
  EXPECT_EQ(shares({shortened(), whole(), shortened(), whole()}, 5), (Shares{0, 1, 0.25, 1, 0.25}));
}

TEST(SecantDecisions, IterationsWithAShareOfItAreCounted) {
  EXPECT_EQ(taken({whole(), shortened(), whole()}, 7).report.solver.values.at("secants"), 3);
  EXPECT_EQ(taken({whole()}, 3).report.solver.values.at("secants"), 0);
}

TEST(SecantDecisions, WithoutATermThatHasOneNothingIsAskedAgain) {
  const ScriptedStep step = taken({shortened(), whole()}, 4, false);
  EXPECT_EQ(step.report.solver.values.at("secants"), 0);
  EXPECT_EQ(taken({shortened(), small()}, 9, false).report.newton_iterations,
            taken({whole(), small()}, 9, false).report.newton_iterations);
}

TEST(SecantDecisions, AStepThatABoundOrNoiseCutWasNotShortened) {
  ScriptedIteration held = whole();
  held.bound = 0.5;
  EXPECT_EQ(shares({held}, 3), (Shares{0, 0, 0}));
  ScriptedIteration noisy = whole();
  noisy.change = [](double alpha) -> Change {
    return alpha > 0.5 ? Change() : Change(EnergyChange{1e-20, 1});
  };
  EXPECT_EQ(shares({noisy, whole()}, 2), (Shares{0, 0}));
}

/// A direction of the secant matrix that is short proves no end: the exact matrix is asked first.
TEST(SecantDecisions, NoStepEndsWithIt) {
  const ScriptedStep step = taken({shortened(), small()}, 9);
  ASSERT_EQ(step.report.status, StepStatus::converged);
  ASSERT_GE(step.system.secants.size(), 3U);
  EXPECT_EQ(step.system.secants[1], 1);
  EXPECT_EQ(step.system.secants[2], 0) << "a small direction asks for the exact matrix at once";
  EXPECT_EQ(step.system.secants.back(), 0);
  EXPECT_EQ(step.system.checks, 1);
}

}  // namespace
}  // namespace bb::secant_decisions_test
