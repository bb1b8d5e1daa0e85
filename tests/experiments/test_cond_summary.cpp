// Statistics of condition numbers: every sample is in them, whatever its status.
#include <gtest/gtest.h>

#include <cmath>

#include "experiments/run/cond_summary.hpp"

namespace bb::cond_summary_test {
namespace {

ConditionSample sample(ConditionStatus status, double lambda_min, double lambda_max, double cond) {
  ConditionSample out;
  out.status = status;
  out.lambda_min = lambda_min;
  out.lambda_max = lambda_max;
  out.cond = cond;
  return out;
}

TEST(CondSummary, a_singular_matrix_counts_with_the_bound) {
  const double nan = std::nan("");
  CondSummary all;
  all.add(sample(ConditionStatus::ok, 1, 100, 100));
  all.add(sample(ConditionStatus::lower_bound, 1e-11, 1e3, 1e14));
  for (int i = 0; i < 3; ++i) all.add(sample(ConditionStatus::singular, nan, 1e4, nan));
  all.add(sample(ConditionStatus::not_pd, nan, nan, nan));
  all.add(sample(ConditionStatus::not_converged, nan, nan, nan));
  const auto cond = all.summary().at("full/none");
  EXPECT_EQ(cond.log10_cond.n, 6U);  // all but the one without a number
  EXPECT_EQ(cond.log10_cond.median.value, 14);
  EXPECT_EQ(cond.log10_cond.min.value, 2);
  EXPECT_EQ(cond.log10_lambda_min.n, 2U);
  EXPECT_EQ(cond.log10_lambda_max.n, 5U);
  const std::map<std::string, int> counted = {
      {"lower_bound", 1}, {"not_converged", 1}, {"not_pd", 1}, {"ok", 1}, {"singular", 3}};
  EXPECT_EQ(cond.statuses, counted);
}

}  // namespace
}  // namespace bb::cond_summary_test
