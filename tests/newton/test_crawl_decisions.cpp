// Steps that crawl, since the regularised Hessian is stiffer than E, get longer: what is required of that, with a number on either side.
#include <gtest/gtest.h>

#include "tests/newton/scripted_system.hpp"

namespace bb::crawl_decisions_test {
namespace {

using test::Change;
using test::ScriptedIteration;
using test::ScriptedStep;

/// A step far from any end, along which E falls by `part` of what its slope of 1 J says, up to `reach` times dx and not beyond.
ScriptedIteration crawl(double part, double t = 0.125, double reach = 1e9) {
  ScriptedIteration at{.dx = 1, .slope = -1};
  at.t = t;
  at.lengthens = true;
  at.bound = 1e9;
  at.change = [=](double length) -> Change {
    return EnergyChange{length > reach ? 1 : -part * length, 1e-3};
  };
  return at;
}

/// How many times dx each iteration took, of `n`; its alpha where dx was not lengthened.
std::vector<double> taken(const std::vector<ScriptedIteration>& script, int n) {
  const ScriptedStep step(script, SaddleRule::escape, 0.1, n);
  std::vector<double> out;
  for (const IterationReport& one : step.iterations) out.push_back(-one.energy_change_J.value);
  return out;
}

/// The first of 60 iterations that tries dx longer; 0: none does.
int first_longer(const std::vector<ScriptedIteration>& script) {
  for (int n = 1; n <= 60; ++n) {
    if (!ScriptedStep(script, SaddleRule::escape, 0.1, n).system.scaled.empty()) return n - 1;
  }
  return 0;
}

TEST(CrawlDecisions, TwentyStepsThatFallAsTheirSlopeLengthenTheNext) {
  EXPECT_EQ(first_longer({crawl(1)}), 20);
  EXPECT_EQ(first_longer({crawl(0.751)}), 20);
  EXPECT_EQ(first_longer({crawl(0.749)}), 0);
  EXPECT_EQ(first_longer({crawl(1, 1)}), 20);
  EXPECT_EQ(first_longer({crawl(1, 0)}), 0) << "the matrix is that of E";
}

TEST(CrawlDecisions, TheyCountInARowAndWhole) {
  std::vector<ScriptedIteration> script(19, crawl(1));
  script.push_back(crawl(0.5));
  script.push_back(crawl(1));
  EXPECT_EQ(first_longer(script), 40);
  ScriptedIteration held = crawl(1);
  held.bound = 0.5;
  EXPECT_EQ(first_longer({held}), 0);
}

/// Twice as long every time, as long as E falls so; then as long as it does.
TEST(CrawlDecisions, TheLengthDoublesAsLongAsEFallsSo) {
  const std::vector<double> found = taken({crawl(1, 0.125, 20)}, 46);
  ASSERT_EQ(found.size(), 46U);
  for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(found[i], 1) << i;
  EXPECT_EQ(found[20], 2);
  EXPECT_EQ(found[21], 4);
  EXPECT_EQ(found[22], 8);
  EXPECT_EQ(found[23], 16);
  EXPECT_EQ(found[24], 16) << "32 is too long, its half is not";
  EXPECT_EQ(found[45], 16);
  const ScriptedStep step({crawl(1, 0.125, 20)}, SaddleRule::escape, 0.1, 46);
  EXPECT_EQ(step.report.solver.values.at("lengthened"), 26);
}

/// Where no longer dx lowers E it is taken as it is, and what was lengthened is undone.
TEST(CrawlDecisions, DxIsTakenAsItIsWhereNothingLongerServes) {
  const ScriptedStep step({crawl(1, 0.125, 1)}, SaddleRule::escape, 0.1, 21);
  ASSERT_EQ(step.system.scaled, (std::vector<double>{2, 0.5}));
  EXPECT_EQ(step.iterations[20].energy_change_J.value, -1);
  EXPECT_EQ(step.iterations[20].alpha, 1);
  EXPECT_EQ(step.report.solver.values.at("lengthened"), 0);
}

/// The bound of the longer motion is kept, and the next length is a power of two.
TEST(CrawlDecisions, ALongerDxKeepsToItsBound) {
  ScriptedIteration near = crawl(1);
  near.bound = 3;
  const ScriptedStep step({near}, SaddleRule::escape, 0.1, 24);
  EXPECT_EQ(step.iterations[20].energy_change_J.value, -2);
  EXPECT_DOUBLE_EQ(step.iterations[21].energy_change_J.value, -0.8 * 3)
      << "4 is bounded by 3, of which 0.8 is taken";
  EXPECT_EQ(step.iterations[21].alpha_ccd, 1) << "of dx, which nothing ends";
  EXPECT_EQ(step.system.scaled[2], 4) << "of 2.4";
}

/// A step that has lengthened dx once is quicker to do it again: after two iterations that crawl.
TEST(CrawlDecisions, TwoAreEnoughInAStepThatHasLengthened) {
  std::vector<ScriptedIteration> script(21, crawl(1));
  script.push_back(crawl(0.5));
  script.push_back(crawl(1));
  const std::vector<double> found = taken(script, 25);
  EXPECT_EQ(found[20], 2);
  EXPECT_EQ(found[21], 2) << "half of 4";
  EXPECT_EQ(found[22], 1);
  EXPECT_EQ(found[23], 1);
  EXPECT_EQ(found[24], 2);
}

/// Behind a longer step nothing is known of the rate: one short direction alone proves no end.
TEST(CrawlDecisions, LeaveNoRateOfConvergenceBehind) {
  std::vector<ScriptedIteration> script(21, crawl(1));
  script.push_back({.dx = ScriptedStep::tolerance / 9.1, .slope = -1e-6});
  script.push_back({.dx = 1});
  EXPECT_EQ(ScriptedStep(script).report.newton_iterations, 22);
  script[21].dx = ScriptedStep::tolerance / 8.9;
  EXPECT_NE(ScriptedStep(script).report.newton_iterations, 22);
}

}  // namespace
}  // namespace bb::crawl_decisions_test
