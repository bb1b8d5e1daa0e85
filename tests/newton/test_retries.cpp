// A step that fails is tried again from its start with half the length: the attempt that fails leaves nothing behind,
// the parts end on the grid of the run, and the report has what was done.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/base/archive/archive.hpp"
#include "core/newton/step_parts.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::retries_test {
namespace {

constexpr double d_hat = 0.01, dt = 0.01;

Method with_policy(const std::string& policy, const std::string& solver,
                   const std::string& integrator = "implicit_euler") {
  Method method = test::fixed_method("log", 20, integrator);
  if (policy != "fixed") {
    PolicyConfig config;
    config.name = policy;
    if (policy == "elasticity_inclusive") config.parameters.emplace("refresh", "per_step");
    method.stiffness = make_policy(config);
  }
  method.linear.name = solver;
  return method;
}

class Watch final : public StepObserver {
 public:
  void on_motion(const Positions& x0, const Positions& x1, int) override { motions.push_back({x0, x1}); }
  void on_iteration(const IterationReport&) override { ++iterations; }
  void on_retry(int) override {
    motions.resize(at_step_end);
    ++retries;
  }
  void on_step(StepSystem&, const StepReport& report, const Positions&) override {
    at_step_end = motions.size();
    reports.push_back(report);
  }
  std::vector<std::pair<Positions, Positions>> motions;
  std::vector<StepReport> reports;
  std::size_t at_step_end = 0;
  int iterations = 0, retries = 0;
};

/// A cap on iterations at which the first step of length dt fails, and one of half the length may pass.
int cap_that_fails(const Scene& scene, Method& method) {
  Simulation simulation(scene, method, dt, 1);
  StepObserver nobody;
  const StepReport step = simulation.step(nobody);
  EXPECT_EQ(step.status, StepStatus::converged) << step.detail;
  EXPECT_GT(step.contacts.total(), 0) << "no contact at the end of the step";
  return step.newton_iterations - 1;
}

TEST(StepParts, halve_and_come_back_to_the_grid) {
  StepParts parts(3);
  EXPECT_EQ(parts.length(dt), dt);
  EXPECT_EQ(parts.end(), 1);
  parts.halve();
  parts.halve();
  EXPECT_EQ(parts.length(dt), dt / 4);
  EXPECT_EQ(parts.end(), 0.25);
  parts.next(true);
  EXPECT_FALSE(parts.at_start());
  EXPECT_EQ(parts.end(), 0.5);
  parts.halve();
  EXPECT_FALSE(parts.can_halve());
  EXPECT_EQ(parts.end(), 0.375);
  int n = 0;
  for (; !parts.at_start(); ++n) parts.next(true);
  EXPECT_EQ(n, 6);
  EXPECT_EQ(parts.length(dt), dt);
  parts.halve();
  parts.next(false);  // ended where it got to
  EXPECT_TRUE(parts.at_start());
  EXPECT_EQ(parts.length(dt), dt);
}

TEST(Retries, an_attempt_that_failed_leaves_nothing_behind) {
  const Scene scene = test::thrown_cloth(d_hat);
  int retried = 0;
  for (const std::string policy : {"fixed", "ipc_adaptive", "elasticity_inclusive"}) {
    for (const std::string solver : {"cholmod", "lagged_cholesky", "pcg"}) {
      Method probe = with_policy(policy, solver), method = with_policy(policy, solver),
             halved = with_policy(policy, solver);
      method.step_solver.max_iterations = halved.step_solver.max_iterations = cap_that_fails(scene, probe);
      method.step_solver.retries = 5;
      Simulation simulation(scene, method, dt, 2);
      Watch watch;
      const StepReport first = simulation.step(watch);
      ASSERT_EQ(first.status, StepStatus::converged) << policy << " " << solver << " " << first.detail;
      ASSERT_GT(first.retries, 0) << policy << " " << solver;
      EXPECT_EQ(first.dt_s, dt / (1 << first.retries));
      EXPECT_EQ(first.newton_iterations, watch.iterations);  // of all attempts
      EXPECT_EQ(watch.retries, first.retries);
      retried += first.retries;

      Simulation alone(scene, halved, first.dt_s, 2);
      Watch other;
      const StepReport same = alone.step(other);
      EXPECT_LT(same.newton_iterations, first.newton_iterations);
      EXPECT_EQ(simulation.history().x, alone.history().x) << policy << " " << solver;
      EXPECT_EQ(simulation.history().v, alone.history().v) << policy << " " << solver;
      EXPECT_EQ(method.stiffness->state().kappa, halved.stiffness->state().kappa);
      const StepReport next = simulation.step(watch), next_alone = alone.step(other);
      if (next.retries > 0 || next_alone.status != StepStatus::converged) continue;
      EXPECT_EQ(simulation.history().x, alone.history().x) << policy << " " << solver;
    }
  }
  EXPECT_GE(retried, 9);
}

TEST(Retries, parts_end_where_the_step_would_have_ended) {
  const Scene scene = test::thrown_cloth(d_hat);
  for (const std::string integrator : {"implicit_euler", "bdf2", "newmark"}) {
    Method probe = with_policy("fixed", "cholmod", integrator),
           method = with_policy("fixed", "cholmod", integrator);
    method.step_solver.max_iterations = cap_that_fails(scene, probe);
    method.step_solver.retries = 6;
    Simulation simulation(scene, method, dt, 6);
    Watch watch;
    double grid = 0, sum = 0;
    int parts = 0;
    while (simulation.nominal_steps() < 6) {
      const int before = simulation.nominal_steps();
      const StepReport step = simulation.step(watch);
      ASSERT_EQ(step.status, StepStatus::converged) << integrator << " " << step.detail;
      EXPECT_EQ(step.step, parts++);
      sum += step.dt_s;
      if (simulation.nominal_steps() == before) continue;
      grid += dt;  // as a run without retries adds it up
      EXPECT_EQ(simulation.time(), grid);
      EXPECT_EQ(step.t_s, grid);
      EXPECT_NEAR(sum, grid, 1e-15);
    }
    EXPECT_GT(parts, 6) << integrator;
    EXPECT_GT(watch.retries, 0);
    ASSERT_FALSE(watch.motions.empty());
    Positions at = scene.x0;
    for (const auto& [from, to] : watch.motions) {  // without those of the attempts that failed: one chain
      EXPECT_EQ(from, at);
      at = to;
    }
    EXPECT_EQ(at, simulation.history().x);
  }
}

TEST(Retries, end_a_step_that_never_converges_after_the_last_one) {
  const Scene scene = test::thrown_cloth(d_hat);
  Method method = with_policy("fixed", "cholmod");
  method.step_solver.max_iterations = 1;
  method.step_solver.retries = 3;
  Simulation simulation(scene, method, dt, 2);
  Watch watch;
  const StepReport step = simulation.step(watch);
  EXPECT_EQ(step.status, StepStatus::iteration_cap);
  EXPECT_EQ(step.retries, 3);
  EXPECT_EQ(step.dt_s, dt / 8);
  EXPECT_EQ(step.newton_iterations, 4);
  EXPECT_EQ(simulation.time(), dt / 8);
  EXPECT_EQ(watch.motions.size(), 1U);
  for (int part = 2; part <= 4; ++part) {  // neither the first nor the last of eight
    EXPECT_EQ(simulation.step(watch).dt_s, dt / 8);
    EXPECT_EQ(simulation.time(), part * dt / 8);
  }
}

/// The load of quasi_static grows with the parts, and is whole at the end: a particle on three springs.
TEST(Retries, halve_the_load_step_of_quasi_static) {
  Scene scene = test::particle_over_plane(0.2, 0, d_hat);
  scene.obstacles.clear();
  scene.bodies = {{"tripod", 0, 4}};
  scene.rest.resize(3, 4);
  scene.rest << 0, 1, -1, -1, 0, 0, 1, -1, 0, 1, 1, 1;
  scene.x0 = scene.rest;
  scene.v0 = Positions::Zero(3, 4);
  scene.mass = {0.2, 0, 0, 0};
  scene.body.assign(4, 0);
  scene.d_hat.assign(4, d_hat);
  scene.offset.assign(4, 0);
  scene.surface_vertices = {};
  scene.springs.edges = {{0, 1}, {0, 2}, {0, 3}};
  scene.springs.stiffness = {20, 20, 20};
  scene.motions.resize(1);
  scene.pins = {{1, 0}, {2, 0}, {3, 0}};
  const auto run = [&scene](int cap, int retries, int n_steps, std::vector<StepReport>* steps) {
    Method method = with_policy("fixed", "cholmod", "quasi_static");
    method.step_solver.tol_velocity = 1e-10;
    method.step_solver.max_iterations = cap;
    method.step_solver.retries = retries;
    Simulation simulation(scene, method, dt, n_steps);
    StepObserver nobody;
    while (simulation.nominal_steps() < n_steps) {
      steps->push_back(simulation.step(nobody));
      if (steps->back().status != StepStatus::converged) break;
    }
    return Positions(simulation.history().x);
  };
  std::vector<StepReport> whole, parts;
  const Positions straight = run(500, 0, 1, &whole);
  ASSERT_EQ(whole[0].status, StepStatus::converged);
  const int needed = whole[0].newton_iterations;
  const Positions halved = run(needed - 1, 4, 1, &parts);
  EXPECT_GT(parts.size(), 1U);
  ASSERT_EQ(parts.back().status, StepStatus::converged) << needed << " " << parts.back().detail;
  EXPECT_GT((straight - scene.x0).norm(), 1e-3);
  EXPECT_LT((straight - halved).norm(), 1e-9);
}

TEST(Retries, bdf2_starts_anew_where_the_length_changes) {
  const Scene scene = test::particle_over_plane(0.2, 1, d_hat);
  const auto integrator = make_integrator("bdf2"), euler = make_integrator("implicit_euler");
  History history;
  history.steps = 3;
  history.dt_prev = dt;
  history.x = scene.x0;
  history.x_prev = test::one_point(0, 0, 0.98);
  history.v = test::one_point(0, 0, 2);
  history.v_prev = test::one_point(0, 0, 2.1);
  history.a = Positions::Zero(3, 1);
  Prediction same, shorter, of_euler;
  integrator->predict(history, dt, same);
  integrator->predict(history, dt / 2, shorter);
  euler->predict(history, dt / 2, of_euler);
  EXPECT_EQ(same.c, 4.0 / 9.0);
  EXPECT_EQ(shorter.c, 1);
  EXPECT_EQ(shorter.x_tilde, of_euler.x_tilde);
  Positions v, a, v_euler, a_euler;
  const Positions x = test::one_point(0, 0, 1.01);
  integrator->finish(history, dt / 2, shorter, x, v, a);
  euler->finish(history, dt / 2, of_euler, x, v_euler, a_euler);
  EXPECT_EQ(v, v_euler);
  integrator->finish(history, dt, same, x, v, a);
  EXPECT_NE(v, Positions((x - history.x) / dt));
}

}  // namespace
}  // namespace bb::retries_test
