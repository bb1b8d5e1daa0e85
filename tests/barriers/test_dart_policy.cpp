// The policy `dart`: DART's own numbers, its bounds, and that kappa goes with the length of the step.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "barriers/stiffness/registry.hpp"
#include "core/base/archive/archive.hpp"
#include "core/math/error.hpp"

namespace bb::dart_policy_test {
namespace {

std::unique_ptr<StiffnessPolicy> dart(const ParameterMap& given = {}, double multiplier = 1) {
  PolicyConfig config;
  config.name = "dart";
  config.parameters = given;
  config.scale = multiplier;
  return make_policy(config);
}

StiffnessGlobals heaviest(double mass, double dt = 1.0 / 250, double c = 1) {
  StiffnessGlobals out;
  out.max_free_mass = mass;
  out.mean_contact_mass = 1e9;  // not read
  out.d_hat = 2e-2;             // DART's
  out.time = {dt, c};
  return out;
}

double started(StiffnessPolicy& policy, const StiffnessGlobals& globals) {
  policy.start(globals);
  double kappa[2] = {0, 0};
  StiffnessBatch rows;
  rows.n = 2;
  policy.fill(rows, kappa);
  EXPECT_EQ(kappa[0], kappa[1]);
  EXPECT_EQ(policy.state().kappa, kappa[0]);
  return kappa[0];
}

/// The pull request: a unit mass at h = 1/250 s and d_hat = 2 cm has the fixed 25; the test there has 40 kg.
TEST(DartPolicy, HasThePublishedNumbers) {
  EXPECT_NEAR(started(*dart(), heaviest(1)), 25, 1e-12);
  EXPECT_NEAR(started(*dart(), heaviest(40)), 1000, 1e-9);
  EXPECT_EQ(started(*dart(), heaviest(0.5)), 25);
  EXPECT_EQ(started(*dart(), heaviest(1e9)), 1e6);
  EXPECT_TRUE([] {
    const auto policy = dart();
    policy->start(heaviest(1e9));
    return policy->state().saturated;
  }());
}

TEST(DartPolicy, TakesOtherBoundsAndOnlyOrderedOnes) {
  EXPECT_NEAR(started(*dart({{"kappa_min_N_per_m", 1e-3}}), heaviest(0.5)), 12.5, 1e-12);
  EXPECT_EQ(started(*dart({{"kappa_max_N_per_m", 300}}), heaviest(40)), 300);
  EXPECT_THROW(dart({{"kappa_min_N_per_m", 2}, {"kappa_max_N_per_m", 1}}), ConfigError);
  EXPECT_THROW(dart({{"kappa_max_N_per_m", 24}}), ConfigError);  // below the lower bound that is not given
  EXPECT_THROW(dart({{"kappa_min_N_per_m", 0}}), ConfigError);
}

TEST(DartPolicy, OfInertiaDoesNotReadTheDistance) {
  const ParameterMap inertia = {{"balance", std::string("inertia")}};
  StiffnessGlobals globals = heaviest(0.5, 0.01, 4.0 / 9);
  const double expected = 0.5 / (4.0 / 9 * 1e-4);
  EXPECT_NEAR(started(*dart(inertia), globals), expected, 1e-9);
  globals.d_hat = 1e-4;
  EXPECT_NEAR(started(*dart(inertia), globals), expected, 1e-9);
  EXPECT_NEAR(started(*dart(inertia, 7), globals), 7 * expected, 1e-8);
  globals.time.c = 0;  // quasi-static: the lower bound
  EXPECT_EQ(started(*dart(inertia), globals), 25);
}

TEST(DartPolicy, GoesWithTheStepAndComesBackFromAnArchive) {
  const auto policy = dart();
  policy->set_time({1.0 / 500, 1});
  EXPECT_EQ(policy->state().kappa, 0);  // no contact yet
  started(*policy, heaviest(40));
  policy->set_time({1.0 / 500, 1});
  EXPECT_NEAR(policy->state().kappa, 4000, 1e-9);
  EXPECT_NEAR(policy->state().kappa_start, 1000, 1e-9);
  EXPECT_TRUE(policy->frozen_in_step());

  Archive written;
  policy->keep(written);
  const auto other = dart();
  Archive read(written.bytes());
  other->keep(read);
  EXPECT_EQ(other->state().kappa, policy->state().kappa);
  other->set_time({1.0 / 250, 1});
  EXPECT_NEAR(other->state().kappa, 1000, 1e-9);
}

}  // namespace
}  // namespace bb::dart_policy_test
