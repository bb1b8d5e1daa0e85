// What a row's kappa is compared with when its policy computes it anew.
#include <gtest/gtest.h>

#include "barriers/stiffness/registry.hpp"
#include "core/terms/stiffness_update.hpp"

namespace bb {
namespace {

constexpr double dt = 0.01;

/// kappa = m/dt^2 of a row of one free vertex.
std::unique_ptr<StiffnessPolicy> inertia_policy() {
  StiffnessPolicyConfig config;
  config.name = "elasticity_inclusive";
  config.parameters.emplace("mass_term", "inertia");
  config.parameters["elastic_term"] = false;
  return make_policy(config);
}

/// Rows of vertex 0 above a plane, one a pair of `pairs`.
ContactTable rows_of(const std::vector<PairId>& pairs) {
  ContactTable rows;
  const std::size_t n = pairs.size();
  rows.resize(n);
  rows.pair = pairs;
  for (std::size_t r = 0; r < n; ++r) {
    rows.vertex[4 * r] = 0;
    for (std::size_t k = 1; k < 4; ++k) rows.vertex[4 * r + k] = -1;
    rows.weight[4 * r] = rows.normal[3 * r + 2] = rows.multiplicity[r] = 1;
    rows.n_free[r] = 1;
    rows.d[r] = 0.005;
    rows.d_hat[r] = 0.01;
    rows.pair_begin[r + 1] = r + 1;
  }
  return rows;
}

struct Updated {
  std::vector<double> mass{0.3};
  std::unique_ptr<StiffnessPolicy> policy = inertia_policy();
  StiffnessUpdate update{*policy, mass};
  BlockSystem blocks{1, {0, 0, 0}};
  BlockSystem::Values elastic;
  MollifiedTable none;

  Updated() { none.resize(0); }
  double refresh(ContactTable& rows) { return update.refresh(rows, none, blocks, elastic); }
  void freeze(ContactTable& rows) { update.freeze(rows, none, blocks, elastic); }
};

TEST(StiffnessUpdate, a_trial_that_was_rejected_says_nothing_of_the_rows_that_stay) {
  Updated u;
  u.update.set_time(dt, 1);
  ContactTable state = rows_of({7});
  EXPECT_EQ(u.refresh(state), 0);  // the row is new
  EXPECT_NEAR(state.kappa[0], 0.3 / (dt * dt), 1e-9);

  ContactTable rejected = rows_of({1, 2, 3});  // more rows than the state has, all of them new
  u.freeze(rejected);
  u.update.set_time(2 * dt, 1);
  EXPECT_NEAR(u.refresh(state), 3, 1e-12);  // kappa fell to a quarter
}

TEST(StiffnessUpdate, a_row_of_an_accepted_trial_is_compared_with_what_it_came_with) {
  Updated u;
  u.update.set_time(dt, 1);
  ContactTable state = rows_of({7});
  u.refresh(state);
  ContactTable accepted = rows_of({7, 8});
  u.freeze(accepted);
  u.update.keep(accepted, u.none);
  EXPECT_EQ(accepted.kappa_before[1], 0);  // met for the first time
  u.update.set_time(2 * dt, 1);
  EXPECT_NEAR(u.refresh(accepted), 3, 1e-12);
  EXPECT_EQ(u.refresh(accepted), 0);  // an iterate that was kept has not changed
}

}  // namespace
}  // namespace bb
