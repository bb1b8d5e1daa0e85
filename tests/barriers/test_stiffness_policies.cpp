// The policies `fixed` and `ipc_adaptive`, and the factory.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "barriers/stiffness/registry.hpp"
#include "core/base/parameters/registry.hpp"
#include "core/math/error.hpp"
#include "tests/barriers/ipc_adaptive.hpp"

namespace bb::stiffness_policies_test {
namespace {

std::vector<double> filled(const StiffnessPolicy& policy, std::size_t n) {
  std::vector<double> kappa(n, -1);
  StiffnessBatch rows;
  rows.n = n;
  policy.fill(rows, kappa.data());
  return kappa;
}

using test::balanced_at;
using test::ipc_adaptive;
using PairEnd = StiffnessPolicy::PairEnd;
const std::vector<PairEnd> pressed{{4e-9, 5e-9, 1e-9}};  // both below 10 parks, shrinking

TEST(FixedPolicy, FillsEveryRow) {
  PolicyConfig config;
  config.parameters["kappa_N_per_m"] = 12;
  config.scale = 0.5;
  const auto policy = make_policy(config);
  EXPECT_EQ(policy->name(), "fixed");
  EXPECT_FALSE(policy->needs_hessian());
  EXPECT_FALSE(policy->needs_globals());
  EXPECT_EQ(filled(*policy, 3), (std::vector<double>{6, 6, 6}));
  EXPECT_EQ(policy->state().kappa, 6);
  EXPECT_EQ(policy->state().kappa_start, 6);
}

TEST(IpcAdaptivePolicy, StartsAtTheBalanceWithinItsBounds) {
  const auto start = [](double balance) {
    const auto policy = ipc_adaptive();
    policy->start(balanced_at(balance));
    return policy->state();
  };
  EXPECT_DOUBLE_EQ(start(40).kappa, 40);
  EXPECT_FALSE(start(40).saturated);
  EXPECT_DOUBLE_EQ(start(1).kappa, 5);    // below k
  EXPECT_DOUBLE_EQ(start(-70).kappa, 5);  // the forces do not press
  EXPECT_DOUBLE_EQ(start(9000).kappa, 500);
  EXPECT_TRUE(start(9000).saturated);

  StiffnessGlobals no_gradient = balanced_at(40);
  no_gradient.grad_b_sq = 0;
  const auto policy = ipc_adaptive();
  EXPECT_TRUE(policy->needs_globals());
  policy->start(no_gradient);
  EXPECT_DOUBLE_EQ(policy->state().kappa, 5);
}

TEST(IpcAdaptivePolicy, AnUpperBoundBelowTheScaleHolds) {
  const auto policy = ipc_adaptive({{"kappa_max_N_per_m", 2}});  // k = 5
  policy->start(balanced_at(40));
  EXPECT_DOUBLE_EQ(policy->state().kappa, 2);
  EXPECT_TRUE(policy->state().saturated);
}

TEST(IpcAdaptivePolicy, DoublesUpToItsBoundAndThenStays) {
  const auto policy = ipc_adaptive({}, 2.0);
  policy->start(balanced_at(40));
  const std::vector<double> expected{80, 160, 320, 500, 500};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    policy->end_step(pressed);
    EXPECT_DOUBLE_EQ(policy->state().kappa, 2 * expected[i]) << i;
    EXPECT_EQ(policy->state().saturated, expected[i] == 500) << i;
  }
  EXPECT_EQ(policy->state().doublings, 4);
  EXPECT_DOUBLE_EQ(policy->state().kappa_start, 80);
  EXPECT_DOUBLE_EQ(filled(*policy, 2)[1], 1000);
}

TEST(IpcAdaptivePolicy, DoublesOnlyWhenSmallTwiceAndShrinking) {
  const std::vector<std::vector<PairEnd>> patient{
      {},
      {{5e-9, 4e-9, 1e-9}},                        // growing
      {{4e-9, 4e-9, 1e-9}},                        // at rest
      {{4e-9, 2e-8, 1e-9}},                        // small once
      {{1e-8, 1.1e-8, 1e-9}},                      // not below 10 parks
      {{2e-9, 3e-9, 1e-10}, {2e-7, 3e-7, 1e-8}}};  // each against its own
  for (const std::vector<PairEnd>& end : patient) {
    const auto policy = ipc_adaptive();
    policy->start(balanced_at(40));
    policy->end_step(end);
    EXPECT_DOUBLE_EQ(policy->state().kappa, 40);
    policy->end_step(pressed);
    EXPECT_DOUBLE_EQ(policy->state().kappa, 80);
  }
  const auto before_start = ipc_adaptive();
  before_start->end_step(pressed);
  EXPECT_EQ(before_start->state().doublings, 0);
}

TEST(IpcAdaptivePolicy, TakesPublishedNumbersInstead) {
  const auto policy =
      ipc_adaptive({{"kappa_min_N_per_m", 50}, {"kappa_max_N_per_m", 150}, {"doubling_gap_m", 1e-6}});
  policy->start(balanced_at(40));
  EXPECT_DOUBLE_EQ(policy->state().kappa, 50);
  policy->end_step(std::vector<PairEnd>{{4e-7, 5e-7, 1e-9}});
  EXPECT_DOUBLE_EQ(policy->state().kappa, 100);
  policy->end_step(std::vector<PairEnd>{{3e-7, 4e-7, 1e-9}});
  EXPECT_DOUBLE_EQ(policy->state().kappa, 150);
  EXPECT_TRUE(policy->state().saturated);
}

TEST(IpcAdaptivePolicy, WithoutInertiaItNeedsBothBounds) {
  StiffnessGlobals quasi_static = balanced_at(40);
  quasi_static.time.c = 0;
  EXPECT_THROW(ipc_adaptive()->start(quasi_static), ConfigError);
  const auto policy = ipc_adaptive({{"kappa_min_N_per_m", 1}, {"kappa_max_N_per_m", 100}});
  policy->start(quasi_static);
  EXPECT_DOUBLE_EQ(policy->state().kappa, 40);
}

TEST(PolicyFactory, HoldsTheBuiltInsAndNamesTheNearest) {
  const std::vector<std::string> names = stiffness_policies().names();
  const std::vector<std::string> expected{"fixed", "ipc_adaptive", "elasticity_inclusive", "dart"};
  ASSERT_GE(names.size(), expected.size());
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), names.begin()));

  PolicyConfig config;
  config.name = "ipc_adaptiv";
  try {
    make_policy(config);
    FAIL() << "no error";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean ipc_adaptive?"), std::string::npos)
        << error.what();
  }
}

TEST(PolicyFactory, RefusesBadNumbers) {
  PolicyConfig config;
  for (const double kappa : {0.0, -1.0, static_cast<double>(NAN), static_cast<double>(INFINITY)}) {
    config.parameters["kappa_N_per_m"] = kappa;
    EXPECT_THROW(make_policy(config), ConfigError) << kappa;
  }
  config.parameters["kappa_N_per_m"] = 1;
  EXPECT_NO_THROW(make_policy(config));
  config.scale = 0;
  EXPECT_THROW(make_policy(config), ConfigError);
  EXPECT_THROW(ipc_adaptive({{"kappa_min_N_per_m", 2}, {"kappa_max_N_per_m", 1}}), ConfigError);
  EXPECT_THROW(ipc_adaptive({{"kappa_min_N_per_m", -2}}), ConfigError);
  EXPECT_THROW(ipc_adaptive({{"doubling_gap_m", 0}}), ConfigError);
}

TEST(PolicyNames, RoundTrip) {
  for (const Refresh refresh : {Refresh::per_iteration, Refresh::per_step}) {
    EXPECT_EQ(require_refresh(to_string(refresh)), refresh);
  }
  EXPECT_THROW(require_refresh("never"), ConfigError);
}

}  // namespace
}  // namespace bb::stiffness_policies_test
