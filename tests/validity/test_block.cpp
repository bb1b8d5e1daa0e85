// The checks of a build: what passes, and what a check makes of nothing, of NaN and of a wrong answer.
#include <gtest/gtest.h>

#include <cmath>

#include "experiments/validity/block.hpp"

namespace bb::block_test {
namespace {

BlockCheck check_with(double bound) {
  BlockCheck check;
  check.name = "made";
  check.bound = bound;
  return check;
}

TEST(BlockCheck, judges_by_the_largest_value_and_names_the_first_that_fails) {
  BlockCheck check = check_with(0.1);
  check.judge(0.05, "first");
  check.judge(0.02, "second");
  EXPECT_TRUE(check.pass());
  EXPECT_EQ(check.value.value, 0.05);
  check.judge(0.2, "third");
  check.judge(0.3, "fourth");
  EXPECT_FALSE(check.pass());
  EXPECT_EQ(check.value.value, 0.3);
  EXPECT_EQ(check.subjects, 4);
  EXPECT_EQ(check.detail, "third: 0.2");
}

TEST(BlockCheck, that_judged_nothing_does_not_pass) { EXPECT_FALSE(check_with(1).pass()); }

TEST(BlockCheck, a_value_that_is_no_number_fails) {
  for (const double bad : {std::nan(""), HUGE_VAL}) {
    BlockCheck check = check_with(1);
    check.judge(0.5, "good");
    check.judge(bad, "bad");
    check.judge(0.5, "good again");
    EXPECT_FALSE(check.pass()) << bad;
    EXPECT_EQ(check.detail.rfind("bad: ", 0), 0U) << check.detail;
  }
}

TEST(Block, every_check_of_this_build_passes_and_has_subjects) {
  const std::vector<BlockCheck> checks = compute_block();
  EXPECT_EQ(checks.size(), 12U);
  for (const BlockCheck& check : checks) {
    EXPECT_TRUE(check.pass()) << check.name << ": " << check.detail;
    EXPECT_GT(check.subjects, 0) << check.name;
    EXPECT_FALSE(check.meaning.empty());
  }
}

}  // namespace
}  // namespace bb::block_test
