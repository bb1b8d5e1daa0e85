// Which pairs a policy that adapts between steps receives.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "core/terms/step_end_gaps.hpp"

namespace bb::step_end_gaps_test {
namespace {

/// Pairs first, first + stride, ... in a random order; the gap of a pair differs from end to end.
std::vector<PairGap> pairs(PairId first, PairId stride, unsigned seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> gap(1e-4, 1e-2);
  std::vector<PairGap> out;
  for (PairId k = 0; k < 200; ++k) out.push_back({first + k * stride, gap(rng), 1e-6 * gap(rng)});
  std::shuffle(out.begin(), out.end(), rng);
  return out;
}

std::span<const StiffnessPolicy::PairEnd> end_step(StepEndGaps& gaps, const std::vector<PairGap>& now) {
  for (const PairGap& each : now) gaps.add(each);
  return gaps.end_step();
}

TEST(StepEndGaps, AreOfThePairsOfTwoStepEndsInARow) {
  StepEndGaps gaps;
  EXPECT_TRUE(end_step(gaps, pairs(5, 2, 1)).empty());
  std::map<PairId, double> before;
  for (const PairGap& each : pairs(5, 2, 1)) before[each.pair] = each.gap;
  const std::vector<PairGap> now = pairs(2, 3, 2);
  std::map<PairId, StiffnessPolicy::PairEnd> expected;
  for (const PairGap& each : now) {
    const auto found = before.find(each.pair);
    if (found != before.end()) expected[each.pair] = {each.gap, found->second, each.park};
  }
  ASSERT_GT(expected.size(), 50U);
  ASSERT_LT(expected.size(), 150U);
  const auto ends = end_step(gaps, now);
  ASSERT_EQ(ends.size(), expected.size());
  auto next = expected.begin();
  int n_closing = 0;
  for (const StiffnessPolicy::PairEnd& end : ends) {
    EXPECT_EQ(end.gap, next->second.gap);
    EXPECT_EQ(end.gap_before, next->second.gap_before);
    EXPECT_EQ(end.park, next->second.park);
    n_closing += end.closing();
    ++next;
  }
  EXPECT_GT(n_closing, 10);
  EXPECT_TRUE(end_step(gaps, pairs(1000000, 1, 3)).empty());  // what was before the last end counts no more
  EXPECT_TRUE(end_step(gaps, now).empty());
}

}  // namespace
}  // namespace bb::step_end_gaps_test
