// Kappa refreshed in every iteration. A Newton step takes kappa for constant, so with kappa = m/d^2 and the
// cubic its error is multiplied by rho = kappa'(d) b'(d) / (-J), J = m/dt^2 + kappa b''(d): by about
// (d_hat - d)/d where inertia is small. Gaps above d_hat/2 converge, gaps below it cycle for ever.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/contact/contact_scenes.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::kappa_cycle_test {
namespace {

constexpr double mass = 0.2, d_hat = 0.01, dt = 0.1;

double kappa_of(double d) { return mass / (d * d); }
double db(double d) { return -2 * (d_hat - d) * (d_hat - d) / d_hat; }
double d2b(double d) { return 4 * (d_hat - d) / d_hat; }

/// Factor by which one iteration multiplies the error at the fixed point d.
double error_factor(double d) {
  const double slope_of_kappa = -2 * kappa_of(d) / d;
  return -slope_of_kappa * db(d) / (mass / (dt * dt) + kappa_of(d) * d2b(d));
}

struct Log final : StepObserver {
  std::vector<double> dx, change, limit_change, limit_gap;
  void on_iteration(const IterationReport& report) override {
    dx.push_back(report.dx_inf_m);
    change.push_back(report.kappa_change_rel.finite() ? report.kappa_change_rel.value : 0);
    limit_change.push_back(report.limit_kappa_change_rel.finite() ? report.limit_kappa_change_rel.value : 0);
    limit_gap.push_back(report.limit_gap_min_rel.value);
  }
};

/// One step from just above the gap at which the barrier carries the weight.
StepReport step_near_rest(double gap, Refresh refresh, Log& log) {
  Scene scene = test::particle_over_plane(mass, gap * (1 + 1e-5), d_hat);
  scene.gravity = Vec3d(0, 0, kappa_of(gap) * db(gap) / mass);
  Method method = test::fixed_method("cubic", 1);
  PolicyConfig policy;
  policy.name = "elasticity_inclusive";
  policy.parameters.emplace("refresh", std::string(to_string(refresh)));
  method.stiffness = make_policy(policy);
  method.step_solver.tol_velocity = 1e-13;
  method.step_solver.max_iterations = 60;
  Simulation simulation(scene, method, dt, 1);
  return simulation.step(log);
}

TEST(KappaCycle, a_gap_above_half_of_d_hat_converges_at_the_rate_of_the_dropped_derivative) {
  const double gap = 0.7 * d_hat, factor = error_factor(gap);
  ASSERT_LT(std::abs(factor), 0.5);
  Log log;
  const StepReport step = step_near_rest(gap, Refresh::per_iteration, log);
  EXPECT_EQ(step.status, StepStatus::converged);
  EXPECT_EQ(step.contacts.obstacle, 1U);
  ASSERT_GT(log.dx.size(), 6U);
  EXPECT_NEAR(log.dx[5] / log.dx[4], std::abs(factor), 1e-3);
  EXPECT_GT(log.change[1], 0);
  EXPECT_EQ(log.change[0], 0);
}

TEST(KappaCycle, a_gap_below_half_of_d_hat_never_converges_and_the_step_says_why) {
  const double gap = 0.3 * d_hat, factor = error_factor(gap);
  ASSERT_GT(std::abs(factor), 2);
  Log log;
  const StepReport step = step_near_rest(gap, Refresh::per_iteration, log);
  EXPECT_NEAR(log.dx[3] / log.dx[2], std::abs(factor), 0.02);  // still close to the fixed point
  EXPECT_EQ(step.status, StepStatus::iteration_cap);
  EXPECT_NE(step.detail.find("the contacts' kappa does not settle"), std::string::npos) << step.detail;
  EXPECT_GT(log.change.back(), 0.01);
  EXPECT_FALSE(step.contact_overload.finite());  // kappa moves, and with it what the row can carry

  const std::size_t n = log.dx.size();
  EXPECT_NEAR(log.dx[n - 1] / log.dx[n - 3], 1, 0.05);  // a cycle of two
}

TEST(KappaCycle, a_contact_that_appears_has_not_changed) {
  Scene scene = test::particle_over_plane(mass, 1.1 * d_hat, d_hat);
  scene.v0.col(0) = Vec3d(0, 0, -0.04);  // to 0.7 d_hat in one step without contact
  scene.gravity.setZero();
  Method method = test::fixed_method("cubic", 1);
  PolicyConfig policy;
  policy.name = "elasticity_inclusive";
  method.stiffness = make_policy(policy);
  Simulation simulation(scene, method, dt, 1);
  Log log;
  ASSERT_EQ(simulation.step(log).contacts.obstacle, 1U);
  ASSERT_GT(log.change.size(), 3U);
  EXPECT_EQ(log.change[1], 0);  // the row is new: its value at d_hat was never one of a line search's start
  EXPECT_GT(log.change.back(), 0);  // an old one by then
}

// A cloth that hangs from its top row with its limit at 0.3 of its width, kappa_e = m_e/y^2: the same cycle.
TEST(KappaCycle, the_step_says_that_it_is_the_strain_limit_whose_kappa_does_not_settle) {
  SceneBuilder builder("hung cloth", true, Vec3d(0, -2180, 0), "test");
  BodySpec spec = test::cloth_spec(2, 0, 1e-4);
  spec.material.youngs = 1;
  spec.material.limit = StrainLimitSpec{0, 0.01};
  PinSpec top;
  top.top_row = true;
  spec.pins = {top};
  builder.add_body(spec);
  const Scene scene = builder.finish();
  Method method = test::fixed_method("cubic", 1);
  method.limit_stiffness = test::elastic_limit({.elastic_term = false});
  method.step_solver.max_iterations = 60;
  Simulation simulation(scene, method, 0.1, 1);
  Log log;
  const StepReport step = simulation.step(log);
  EXPECT_EQ(step.status, StepStatus::iteration_cap);
  EXPECT_NE(step.detail.find("the strain limit's kappa does not settle"), std::string::npos) << step.detail;
  EXPECT_EQ(step.detail.find("contacts' kappa"), std::string::npos) << step.detail;
  EXPECT_EQ(*std::max_element(log.change.begin(), log.change.end()), 0);  // of the contacts: there are none
  EXPECT_EQ(log.limit_change.front(), 0);
  EXPECT_GT(log.limit_change.back(), 0.01);
  EXPECT_GT(log.limit_gap.back(), 0);
  EXPECT_LT(log.limit_gap.back(), 1);
  EXPECT_FALSE(step.limit_overload.finite());
}

/// kappa = m/d^2 kept for a step: a contact that a line search met keeps the value at d_hat, at which
/// it was met.
TEST(KappaCycle, a_contact_that_a_line_search_meets_keeps_its_kappa_for_the_step) {
  Scene scene = test::particle_over_plane(mass, 1.1 * d_hat, d_hat);
  scene.v0.col(0) = Vec3d(0, 0, -0.04);
  scene.gravity.setZero();
  Method method = test::fixed_method("cubic", 1);
  PolicyConfig policy;
  policy.name = "elasticity_inclusive";
  policy.parameters.emplace("refresh", "per_step");
  method.stiffness = make_policy(policy);
  Simulation simulation(scene, method, dt, 1);
  Log log;
  ASSERT_EQ(simulation.step(log).contacts.obstacle, 1U);
  ASSERT_GT(log.dx.size(), 2U);  // refreshed after it was met
  ASSERT_LT(simulation.history().x(2, 0), 0.99 * d_hat);
  EXPECT_NEAR(test::rows_of(simulation.system()).rows.kappa.at(0), kappa_of(d_hat), 1e-9 * kappa_of(d_hat));
}

/// Two rods that cross at an angle of 0.04 and close: their one row is mollified.
TEST(KappaCycle, a_mollified_row_whose_kappa_moves_is_seen) {
  Scene scene;
  test::add_body(scene, "rod", {Vec3d(-0.5, 0, 0), Vec3d(0.5, 0, 0)}, {}, d_hat);
  test::add_body(scene, "other", {Vec3d(-0.5, -0.01, 0.008), Vec3d(0.5, 0.01, 0.008)}, {}, d_hat);
  scene.surface_edges = {{0, 1}, {2, 3}};
  scene.v0.rightCols(2).row(2).setConstant(-0.02);
  Method method = test::fixed_method("cubic", 1);
  PolicyConfig policy;
  policy.name = "elasticity_inclusive";
  method.stiffness = make_policy(policy);
  Simulation simulation(scene, method, dt, 1);
  Log log;
  const StepReport report = simulation.step(log);
  ASSERT_EQ(report.contacts.mollified, 1U);
  ASSERT_EQ(report.contacts.total(), 1U);
  EXPECT_EQ(log.change.at(0), 0);
  EXPECT_GT(*std::max_element(log.change.begin(), log.change.end()), 0.01);
}

TEST(KappaCycle, kept_for_the_step_both_converge) {
  for (const double gap : {0.7 * d_hat, 0.3 * d_hat}) {
    Log log;
    const StepReport step = step_near_rest(gap, Refresh::per_step, log);
    EXPECT_EQ(step.status, StepStatus::converged);
    EXPECT_EQ(step.contacts.obstacle, 1U);
    EXPECT_EQ(*std::max_element(log.change.begin(), log.change.end()), 0);
  }
}

}  // namespace
}  // namespace bb::kappa_cycle_test
