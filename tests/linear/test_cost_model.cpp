// The work of a pattern against what a dense factor takes, and the choice between solvers against sums by hand.
#include "core/linear/cost_model.hpp"

#include <gtest/gtest.h>

#include "tests/linear/systems.hpp"

namespace bb::cost_model_test {
namespace {

const LinearWork work{100, 700, 2000, 50000};
const LinearCost by_flop{"cholmod", "", {0.001, 0, 0, 0, 1e-6}};      // 0.051 s
const LinearCost by_iterations{"pcg", "ic0", {0, 1e-6, 2e-6, 0, 0}};  // 0.0147 s

TEST(CostModel, TheWorkOfADensePatternIsThatOfADenseFactor) {
  const double n = 12;
  const LinearWork dense =
      linear_work(from_dense(Eigen::MatrixXd::Identity(12, 12) * 3 + Eigen::MatrixXd::Ones(12, 12)));
  EXPECT_EQ(dense.unknowns, n);
  EXPECT_EQ(dense.entries, n * (n + 1) / 2);
  EXPECT_EQ(dense.factor_entries, n * (n + 1) / 2);
  EXPECT_EQ(dense.factor_flop, n * (n + 1) * (2 * n + 1) / 6);  // squares of the column lengths
}

TEST(CostModel, TheValuesDoNotMatterAndNoUnknownsAreNoWork) {
  ReducedSystem grid = grid_system(5, 10);
  const LinearWork before = linear_work(grid);
  EXPECT_GT(before.factor_entries, before.entries);
  for (Eigen::Index i = 0; i < grid.lower.nonZeros(); ++i) grid.lower.valuePtr()[i] = 0;
  EXPECT_EQ(linear_work(grid).factor_flop, before.factor_flop);
  EXPECT_EQ(linear_work(from_dense(Eigen::MatrixXd(0, 0))).factor_flop, 0);
}

TEST(CostModel, SecondsAreTheSumOfTheWorkTerms) {
  EXPECT_DOUBLE_EQ(by_flop.seconds(work), 0.051);
  EXPECT_DOUBLE_EQ(by_iterations.seconds(work), 1e-6 * 700 + 2e-6 * 7000);
  const LinearCost each{"cholmod", "", {1, 1, 1, 1, 1}};
  EXPECT_DOUBLE_EQ(each.seconds(work), 1 + 700 + 7000 + 2000 + 50000);
}

TEST(CostModel, TheCheapestIsChosenAndOfEqualOnesTheFirst) {
  EXPECT_EQ(cheapest({by_flop, by_iterations}, work), 1u);
  EXPECT_EQ(cheapest({by_iterations, by_flop}, work), 0u);
  EXPECT_EQ(cheapest({by_flop, by_flop}, work), 0u);
  LinearWork small = work;
  small.factor_flop = 1000;  // 0.002 s
  EXPECT_EQ(cheapest({by_iterations, by_flop}, small), 1u);
  EXPECT_EQ(cost_text({by_flop, by_iterations}, work), "pcg with ic0 0.0147 s, cholmod 0.051 s");
}

}  // namespace
}  // namespace bb::cost_model_test
