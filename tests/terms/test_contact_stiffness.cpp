// What a row's kappa is compared with when its policy computes it anew.
#include <gtest/gtest.h>

#include "barriers/stiffness/registry.hpp"
#include "core/exec/host_executor.hpp"
#include "core/terms/contact_stiffness.hpp"

namespace bb::contact_stiffness_test {
namespace {

constexpr double dt = 0.01;

/// kappa = m/dt^2 of a row of one free vertex.
std::unique_ptr<StiffnessPolicy> inertia_policy() {
  PolicyConfig config;
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
    rows.weight[4 * r] = rows.normal[3 * r + 2] = 1;
    rows.n_free[r] = 1;
    rows.d[r] = 0.005;
    rows.d_hat[r] = 0.01;
  }
  return rows;
}

struct Updated {
  std::vector<double> mass{0.3};
  std::unique_ptr<StiffnessPolicy> policy;
  exec::HostExecutor executor;
  ContactStiffness update{executor, *policy, mass};
  BlockSystem blocks{1, {0, 0, 0}};
  BlockSystem::Values elastic;
  MollifiedTable none;

  explicit Updated(std::unique_ptr<StiffnessPolicy> given = inertia_policy()) : policy(std::move(given)) {
    none.resize(0);
  }
  double refresh(ContactTable& rows) { return update.refresh({rows, none}, blocks, elastic); }
  /// state: the rows of the iterate.
  void freeze(ContactTable& trial, ContactTable& state) {
    update.freeze({trial, none}, {state, none}, blocks, elastic);
  }
};

TEST(ContactStiffness, a_trial_that_was_rejected_says_nothing_of_the_rows_that_stay) {
  Updated u;
  u.update.set_time({dt, 1});
  ContactTable state = rows_of({7});
  EXPECT_EQ(u.refresh(state), 0);  // the row is new
  EXPECT_NEAR(state.kappa[0], 0.3 / (dt * dt), 1e-9);

  ContactTable rejected = rows_of({1, 2, 3});  // more rows than the state has, all of them new
  u.freeze(rejected, state);
  u.update.set_time({2 * dt, 1});
  EXPECT_NEAR(u.refresh(state), 3, 1e-12);  // kappa fell to a quarter
}

TEST(ContactStiffness, a_row_of_an_accepted_trial_is_compared_with_what_it_came_with) {
  Updated u;
  u.update.set_time({dt, 1});
  ContactTable state = rows_of({7});
  u.refresh(state);
  ContactTable accepted = rows_of({7, 8});
  u.freeze(accepted, state);
  u.update.keep({accepted, u.none});
  EXPECT_EQ(accepted.kappa_before[1], 0);  // met for the first time
  u.update.set_time({2 * dt, 1});
  EXPECT_NEAR(u.refresh(accepted), 3, 1e-12);
  EXPECT_EQ(u.refresh(accepted), 0);  // an iterate that was kept has not changed
}

/// kappa = n^T H n + m/d^2 once a step.
std::unique_ptr<StiffnessPolicy> step_policy(const char* derivative) {
  PolicyConfig config;
  config.name = "elasticity_inclusive";
  config.parameters.emplace("refresh", "per_step");
  config.parameters.emplace("derivative", derivative);
  return make_policy(config);
}

/// Rows of one free vertex of mass 0.3 kg.
struct Folded : Updated {
  explicit Folded(const char* derivative = "included") : Updated(step_policy(derivative)) {
    blocks.set_elements({});
    set_elastic(2);
  }
  void set_elastic(double diagonal) {
    elastic.assign(9, 0.0);
    elastic[0] = elastic[4] = elastic[8] = diagonal;
  }
  KappaParts met(PairId pair, double mass_of_vertex, double gap) {
    mass[0] = mass_of_vertex;
    ContactTable trial = rows_of({pair}), state = rows_of({});
    trial.d[0] = gap;
    freeze(trial, state);
    EXPECT_EQ(trial.kappa[0], trial.parts[0].at(gap));
    return trial.parts[0];
  }
};

TEST(ContactStiffness, a_potential_keeps_what_a_pair_was_first_met_with_also_in_a_rejected_trial) {
  Folded u;
  ContactTable state = rows_of({7});
  u.refresh(state);
  EXPECT_DOUBLE_EQ(state.parts[0].fixed, 2);
  EXPECT_DOUBLE_EQ(state.parts[0].per_gap_sq, 0.3);
  EXPECT_DOUBLE_EQ(state.kappa[0], 2 + 0.3 / (0.005 * 0.005));

  EXPECT_DOUBLE_EQ(u.met(8, 0.5, 0.004).per_gap_sq, 0.5);  // no keep(): the trial was rejected
  EXPECT_DOUBLE_EQ(u.met(8, 0.9, 0.002).per_gap_sq, 0.5);  // met again, elsewhere
  EXPECT_DOUBLE_EQ(u.met(9, 0.9, 0.002).per_gap_sq, 0.9);
  u.update.begin_step();
  EXPECT_DOUBLE_EQ(u.met(8, 0.9, 0.002).per_gap_sq, 0.9);

  Folded dropped("dropped");
  EXPECT_DOUBLE_EQ(dropped.met(8, 0.5, 0.004).fixed, 2 + 0.5 / (0.01 * 0.01));  // at d_hat
  EXPECT_DOUBLE_EQ(dropped.met(8, 0.9, 0.004).fixed, 2 + 0.9 / (0.01 * 0.01));
}

TEST(ContactStiffness, a_potential_reads_the_matrix_of_the_step_s_first_iterate) {
  Folded u;
  ContactTable state = rows_of({7});
  u.refresh(state);
  u.set_elastic(5);
  EXPECT_DOUBLE_EQ(u.met(8, 0.3, 0.004).fixed, 2);
  u.update.begin_step();
  EXPECT_DOUBLE_EQ(u.met(8, 0.3, 0.004).fixed, 5);
}

}  // namespace
}  // namespace bb::contact_stiffness_test
