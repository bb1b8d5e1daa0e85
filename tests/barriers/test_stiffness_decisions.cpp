// What decides in a stiffness policy: the bounds of a kappa that adapts and when it doubles, and on what a factor of
// the config acts. Each with a number on either side.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/barriers/ipc_adaptive.hpp"

namespace bb::stiffness_decisions_test {
namespace {

using test::balanced_at;
using test::ipc_adaptive;
using PairEnd = StiffnessPolicy::PairEnd;

constexpr double scale = 5, range = 100;  // k in N/m; kappa stays within [k, 100 k]

const std::vector<double> balances = {-7, 0.3, 4.5, 5.5, 40, 480, 520, 7000, 1e9};

/// A bound that is given holds, wherever it lies; the other one is the policy's own where it does not contradict.
TEST(StiffnessDecisions, AGivenBoundOfKappaHoldsOnEitherSideOfThePolicysOwn) {
  for (const double low : {0.01, 4.9, 5.1, 60.0, 499.0, 501.0, 1e6}) {
    for (const double balance : balances) {
      const auto policy = ipc_adaptive({{"kappa_min_N_per_m", low}});
      policy->start(balanced_at(balance));
      const double high = std::max(range * scale, low);
      EXPECT_DOUBLE_EQ(policy->state().kappa, std::clamp(balance, low, high)) << low << " " << balance;
      EXPECT_GE(policy->state().kappa, low);
      EXPECT_EQ(policy->state().saturated, balance >= high || low >= high) << low << " " << balance;
    }
  }
  for (const double high : {0.01, 4.9, 5.1, 60.0, 499.0, 501.0, 1e6}) {
    for (const double balance : balances) {
      const auto policy = ipc_adaptive({{"kappa_max_N_per_m", high}});
      policy->start(balanced_at(balance));
      const double low = std::min(scale, high);
      EXPECT_DOUBLE_EQ(policy->state().kappa, std::clamp(balance, low, high)) << high << " " << balance;
      EXPECT_EQ(policy->state().saturated, balance >= high || low >= high) << high << " " << balance;
    }
  }
}

/// The last doubling goes to the upper bound and no farther, whichever bound that is.
TEST(StiffnessDecisions, DoublingsEndAtTheUpperBound) {
  const std::vector<PairEnd> pressed{{4e-9, 5e-9, 1e-9}};
  struct Case {
    ParameterMap given;
    double start, end;
  };
  const Case cases[] = {{{}, 40, 500},
                        {{{"kappa_max_N_per_m", 300}}, 40, 300},
                        {{{"kappa_max_N_per_m", 320}}, 40, 320},
                        {{{"kappa_min_N_per_m", 60}}, 60, 500},
                        {{{"kappa_min_N_per_m", 2000}}, 2000, 2000}};
  for (const Case& one : cases) {
    const auto policy = ipc_adaptive(one.given);
    policy->start(balanced_at(40));
    double expected = one.start;
    int doublings = 0;
    for (int i = 0; i < 8; ++i) {
      EXPECT_DOUBLE_EQ(policy->state().kappa, expected);
      EXPECT_EQ(policy->state().saturated, expected == one.end);
      EXPECT_EQ(policy->state().doublings, doublings);
      doublings += expected < one.end;
      expected = std::min(2 * expected, one.end);
      policy->end_step(pressed);
    }
    EXPECT_DOUBLE_EQ(policy->state().kappa, one.end);
  }
}

/// A pair doubles kappa if it is small at two ends in a row and closing: each of the three alone is not enough.
TEST(StiffnessDecisions, KappaDoublesForAPairThatIsSmallTwiceAndClosing) {
  const double park = 1e-9, given = 3e-6;
  for (const double small : {10 * park, given}) {
    const auto doublings = [&](double gap, double before) {
      const auto policy = small == given ? ipc_adaptive({{"doubling_gap_m", given}}) : ipc_adaptive();
      policy->start(balanced_at(40));
      // beside a pair that is far from it
      policy->end_step(std::vector<PairEnd>{{0.5, 0.6, park}, {gap * small, before * small, park}});
      return policy->state().doublings;
    };
    EXPECT_EQ(doublings(0.5, 0.6), 1);
    EXPECT_EQ(doublings(0.5, 0.999), 1);
    EXPECT_EQ(doublings(0.5, 1.001), 0);  // small for the first time
    EXPECT_EQ(doublings(0.5, 1e6), 0);
    EXPECT_EQ(doublings(1.001, 1.002), 0);  // not small
    EXPECT_EQ(doublings(0.5, 0.5), 0);      // stays
    EXPECT_EQ(doublings(0.500001, 0.5), 0);
    EXPECT_EQ(doublings(0.5, 0.500001), 1);
    EXPECT_EQ(doublings(1.001, 0.999), 0);
  }
}

TEST(StiffnessDecisions, OnePairDoublesAndManyDoubleOnce) {
  const PairEnd presses{4e-9, 5e-9, 1e-9}, opens{5e-9, 4e-9, 1e-9};
  const auto policy = ipc_adaptive();
  policy->start(balanced_at(40));
  policy->end_step(std::vector<PairEnd>{opens, opens, presses});
  EXPECT_DOUBLE_EQ(policy->state().kappa, 80);
  policy->end_step(std::vector<PairEnd>{presses, opens, presses, presses});
  EXPECT_DOUBLE_EQ(policy->state().kappa, 160);
  EXPECT_EQ(policy->state().doublings, 2);
}

/// One row of two free vertices with an elastic matrix, its columns and the batch.
struct OneRow {
  int n_free = 2;
  double weight[4] = {1, -0.6, 0, 0}, normal[3] = {0, 0.6, 0.8}, mass[4] = {2e-3, 5e-3, 0, 0};
  double d = 3e-4, d_hat = 1e-3;
  std::vector<double> hessian = std::vector<double>(144, 0.0);

  OneRow() {
    for (std::size_t i = 0; i < 6; ++i) hessian[13 * i] = 30 + static_cast<double>(i);
  }
  StiffnessBatch batch() const {
    return {1, &n_free, weight, normal, &d, &d_hat, mass, hessian.data(), 0.01, 0.25};
  }
};

std::unique_ptr<StiffnessPolicy> inclusive(const char* mass_term, bool elastic, const char* derivative,
                                           double multiplier) {
  PolicyConfig config;
  config.name = "elasticity_inclusive";
  config.parameters.emplace("mass_term", mass_term);
  config.parameters["elastic_term"] = elastic;
  config.parameters.emplace("refresh", "per_step");
  config.parameters.emplace("derivative", derivative);
  config.scale = multiplier;
  return make_policy(config);
}

/// A matched scale is one factor on the whole of kappa, whatever kappa is made of.
TEST(StiffnessDecisions, AMultiplierActsOnEveryPartOfKappa) {
  OneRow row;
  for (const bool elastic : {true, false}) {
    for (const char* mass_term : {"paper", "inertia", "scaled", "none"}) {
      if (!elastic && std::string(mass_term) == "none") continue;
      double one = 0, scaled = 0;
      inclusive(mass_term, elastic, "dropped", 1)->fill(row.batch(), &one);
      inclusive(mass_term, elastic, "dropped", 7)->fill(row.batch(), &scaled);
      ASSERT_GT(one, 0) << mass_term;
      EXPECT_DOUBLE_EQ(scaled, 7 * one) << mass_term;
    }
    for (const char* mass_term : {"paper", "scaled"}) {
      KappaParts one, scaled;
      inclusive(mass_term, elastic, "included", 1)->fill_parts(row.batch(), &one);
      inclusive(mass_term, elastic, "included", 7)->fill_parts(row.batch(), &scaled);
      ASSERT_EQ(one.fixed > 0, elastic) << mass_term;
      ASSERT_GT(one.per_gap_sq, 0) << mass_term;
      EXPECT_DOUBLE_EQ(scaled.fixed, 7 * one.fixed) << mass_term;
      EXPECT_DOUBLE_EQ(scaled.per_gap_sq, 7 * one.per_gap_sq) << mass_term;
    }
  }
  const auto policy = ipc_adaptive({}, 7), plain = ipc_adaptive({}, 1);
  policy->start(balanced_at(40)), plain->start(balanced_at(40));
  double scaled = 0, one = 0;
  policy->fill(row.batch(), &scaled), plain->fill(row.batch(), &one);
  ASSERT_GT(one, 0);
  EXPECT_DOUBLE_EQ(scaled, 7 * one);
  EXPECT_DOUBLE_EQ(policy->state().kappa, scaled);
  EXPECT_DOUBLE_EQ(policy->state().kappa_start, 7 * plain->state().kappa_start);
}

/// As numbers of a rule, for pipelines without virtual calls, and as the policy itself: one kappa at every gap.
TEST(StiffnessDecisions, PartsAndNumberAreOneKappaAtEveryGap) {
  OneRow row;
  for (const char* mass_term : {"paper", "scaled"}) {
    KappaParts parts;
    inclusive(mass_term, true, "included", 7)->fill_parts(row.batch(), &parts);
    for (const double d : {1e-6, 1e-4, 5e-4, 9.9e-4}) {
      row.d = d;
      double kappa = 0;
      inclusive(mass_term, true, "dropped", 7)->fill(row.batch(), &kappa);
      EXPECT_NEAR(parts.at(d), kappa, 1e-12 * kappa) << mass_term << " " << d;
    }
  }
}

}  // namespace
}  // namespace bb::stiffness_decisions_test
