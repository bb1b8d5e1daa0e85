// What is carried from step to step: states, velocities, time, load; and what is not.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/newton/small_scenes.hpp"

namespace bb::simulation_test {
namespace {

constexpr double mass = 0.2, d_hat = 0.01, dt = 0.01;

/// The integrator on its own, along z: x = x_tilde + c h^2 g after every prediction.
struct HandDriven {
  std::unique_ptr<Integrator> integrator;
  History history;
  Prediction prediction;
  Positions v, a;

  HandDriven(const std::string& name, const Scene& scene) : integrator(make_integrator(name)) {
    history.x = history.x_prev = scene.x0;
    history.v = history.v_prev = scene.v0;
    history.a =
        integrator->needs_acceleration() ? Positions(scene.gravity) : Positions(Positions::Zero(3, 1));
  }
  void step(const Vec3d& gravity) {
    integrator->predict(history, dt, prediction);
    const Positions x = prediction.x_tilde + prediction.c * dt * dt * gravity;
    integrator->finish(history, dt, prediction, x, v, a);
    history.x_prev = history.x;
    history.v_prev = history.v;
    history.x = x;
    history.v = v;
    history.a = a;
    ++history.steps;
  }
};

TEST(Simulation, hands_every_integrator_the_history_that_it_asks_for) {
  int tested = 0;
  for (const IntegratorEntry& entry : integrators()) {
    if (make_integrator(entry.name)->quasi_static()) continue;
    Scene scene = test::particle_over_plane(mass, 1, d_hat);
    scene.v0.col(0) = Vec3d(1, 0, 3);
    HandDriven hand(entry.name, scene);
    Method method = test::fixed_method("log", 1, entry.name);
    Simulation simulation(scene, method, dt, 6);
    StepObserver nobody;
    for (int i = 1; i <= 6; ++i) {
      const StepReport report = simulation.step(nobody);
      hand.step(method.integrator->weight_factor() * scene.gravity);
      ASSERT_EQ(report.status, StepStatus::converged);
      EXPECT_LT((simulation.history().x - hand.history.x).norm(), 1e-12) << entry.name << " " << i;
      EXPECT_LT((simulation.history().v - hand.history.v).norm(), 1e-9) << entry.name << " " << i;
      EXPECT_NEAR(report.t_s, i * dt, 1e-14);
      EXPECT_NEAR(report.kinetic_J, 0.5 * mass * hand.history.v.squaredNorm(), 1e-9) << entry.name;
      EXPECT_EQ(simulation.history().steps, i);
    }
    ++tested;
  }
  EXPECT_GE(tested, 3);
}

/// A particle on three springs that meet in it: an anchor above, to each side.
Scene tripod(double gravity) {
  Scene scene = test::particle_over_plane(mass, 0, d_hat);
  scene.obstacles.clear();
  scene.bodies = {{"tripod", 0, 4}};
  scene.rest.resize(3, 4);
  scene.rest << 0, 1, -1, -1, 0, 0, 1, -1, 0, 1, 1, 1;
  scene.x0 = scene.rest;
  scene.v0 = Positions::Zero(3, 4);
  scene.mass = {mass, 0, 0, 0};
  scene.body = {0, 0, 0, 0};
  scene.d_hat.assign(4, d_hat);
  scene.offset.assign(4, 0);
  scene.surface_vertices = {};
  scene.springs.edges = {{0, 1}, {0, 2}, {0, 3}};
  scene.springs.stiffness = {20, 20, 20};
  scene.motions.resize(1);
  scene.pins = {{1, 0}, {2, 0}, {3, 0}};
  scene.gravity = Vec3d(0, 0, -gravity);
  return scene;
}

std::vector<double> sag(double gravity, int load_steps) {
  const Scene scene = tripod(gravity);
  Method method = test::fixed_method("log", 1, "quasi_static");
  method.step_solver.tol_velocity = 1e-10;
  Simulation simulation(scene, method, dt, load_steps);
  StepObserver nobody;
  std::vector<double> out;
  for (int i = 0; i < load_steps; ++i) {
    EXPECT_EQ(simulation.step(nobody).status, StepStatus::converged);
    out.push_back(-simulation.history().x(2, 0));
    EXPECT_EQ(simulation.history().v.norm(), 0);
  }
  return out;
}

TEST(Simulation, load_steps_end_with_the_whole_load) {
  const std::vector<double> steps = sag(10, 4);
  for (std::size_t i = 0; i < 4; ++i) {
    const double share = 0.25 * static_cast<double>(i + 1);
    const double alone = sag(10 * share, 1).back();
    ASSERT_GT(alone, 0.005);
    EXPECT_NEAR(steps[i], alone, 1e-9) << i;
  }
}

/// A cloth hung from two corners that stretches into its limit and meets a floor: with policies kept
/// for a step.
Scene hung_cloth() {
  SceneBuilder builder("hung cloth", false, Vec3d(0, 0, -10), "test");
  BodySpec spec = test::cloth_spec(4, 0.004, d_hat);
  spec.material.limit = StrainLimitSpec{0.01, 0.01};
  spec.material.bending = 1e-4;
  PinSpec pin;
  pin.indices = {0, 3};
  spec.pins = {pin};
  spec.velocity = Vec3d(0.4, 0.8, -0.5);
  builder.add_body(spec);
  Obstacle plane;
  plane.name = "floor";
  builder.add_obstacle(plane);
  return builder.finish();
}

Method kept_for_the_step() {
  Method method = test::fixed_method("cubic", 1);
  PolicyConfig policy;
  policy.name = "elasticity_inclusive";
  policy.parameters.emplace("refresh", "per_step");
  method.stiffness = make_policy(policy);
  method.limit_stiffness = test::elastic_limit({.refresh = Refresh::per_step});
  return method;
}

TEST(Simulation, a_step_of_implicit_euler_depends_on_nothing_but_the_state_at_its_start) {
  const Scene scene = hung_cloth();
  Method method = kept_for_the_step();
  Simulation simulation(scene, method, dt, 4);
  StepObserver nobody;
  double tension = 0;
  std::size_t contacts = 0;
  for (int i = 0; i < 4; ++i) {
    Scene from_here = scene;
    from_here.x0 = simulation.history().x;
    from_here.v0 = simulation.history().v;
    Method again = kept_for_the_step();
    Simulation fresh(from_here, again, dt, 1);
    const StepReport one = simulation.step(nobody), other = fresh.step(nobody);
    ASSERT_EQ(one.status, StepStatus::converged) << one.detail;
    EXPECT_EQ(one.newton_iterations, other.newton_iterations) << i;
    EXPECT_TRUE((simulation.history().x.array() == fresh.history().x.array()).all()) << i;
    tension = std::max(tension, one.limit_load_max_N_per_m.value);
    contacts += one.contacts.total();
  }
  EXPECT_GT(tension, 0);
  EXPECT_GT(contacts, 10U);
}

class Watch final : public StepObserver {
 public:
  void on_iteration(const IterationReport& report) override { reports.push_back(report); }
  void on_motion(const Positions& x0, const Positions& x1, int) override { motions.push_back({x0, x1}); }
  std::vector<IterationReport> reports;
  std::vector<std::pair<Positions, Positions>> motions;
};

/// kappa of a limit that is refreshed in every iteration: no change in the first iterate of a step, whatever
/// it was in the step before, and one where elements carry a force.
TEST(Simulation, the_change_of_a_limits_kappa_is_measured_within_a_step_and_where_it_acts) {
  const auto run = [](double limit) {
    SceneBuilder builder("hung cloth", false, Vec3d(0, -10, 0), "test");
    BodySpec spec = test::cloth_spec(4, 0, d_hat);
    spec.material.limit = StrainLimitSpec{0.5 * limit, 0.5 * limit};
    PinSpec pin;
    pin.indices = {12, 13, 14, 15};
    spec.pins = {pin};
    spec.velocity = Vec3d(0, -1, 0);
    builder.add_body(spec);
    const Scene scene = builder.finish();
    Method method = test::fixed_method("cubic", 1);
    method.limit_stiffness = test::elastic_limit();
    Simulation simulation(scene, method, dt, 3);
    Watch watch;
    for (int i = 0; i < 3; ++i) simulation.step(watch);
    return watch.reports;
  };
  double largest = 0, tension = 0;
  int later_steps = 0;
  for (const IterationReport& report : run(0.01)) {
    if (report.iteration == 0) {
      EXPECT_STREQ(report.limit_kappa_change_rel.status, "first_iteration");
      EXPECT_FALSE(report.kappa_change_rel.finite());
      later_steps += report.step > 0;
    }
    if (report.iteration > 0) {
      EXPECT_EQ(report.kappa_change_rel.value, 0);  // of the contacts, of which there are none
      largest = std::max(largest, report.limit_kappa_change_rel.value);
    }
    tension = std::max(tension, report.limit_load_max_N_per_m.value);
  }
  EXPECT_EQ(later_steps, 2);
  EXPECT_GT(tension, 0);
  EXPECT_GT(largest, 1e-3);
  for (const IterationReport& report : run(5)) {  // no element comes near such a limit
    EXPECT_EQ(report.limit_load_max_N_per_m.value, 0);
    if (report.iteration > 0) {
      EXPECT_EQ(report.limit_kappa_change_rel.value, 0);
    }
  }
}

TEST(Simulation, accepted_motions_follow_each_other_from_the_start_to_the_end) {
  Scene scene = test::particle_over_plane(mass, 0.9 * d_hat, d_hat);
  scene.v0(2, 0) = -0.5;
  Method method = test::fixed_method("log", 40);
  Simulation simulation(scene, method, dt, 3);
  Watch watch;
  for (int i = 0; i < 3; ++i) ASSERT_EQ(simulation.step(watch).status, StepStatus::converged);
  ASSERT_EQ(watch.motions.size(), watch.reports.size());
  Positions at = scene.x0;
  for (const auto& [from, to] : watch.motions) {
    EXPECT_EQ(from, at);
    at = to;
  }
  EXPECT_EQ(at, simulation.history().x);
  EXPECT_NE(at, scene.x0);
}

}  // namespace
}  // namespace bb::simulation_test
