// Soft pins, the air and gravity over time, against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "core/model/mesh/solid_generators.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::driven_test {
namespace {

/// A particle of 0.2 kg far from everything, which a spring of 50 N/m pulls.
Scene pulled_particle(const Vec3d& velocity) {
  Scene scene = test::particle_over_plane(0.2, 100, 0.01);
  scene.motions.emplace_back();
  scene.motions[0].velocity = velocity;
  scene.pulls = {{{0}, 0, 50, {}}};
  return scene;
}

struct Steps {
  Scene scene;
  Method method = test::fixed_method("log", 1);
  double dt;
  Simulation simulation;
  Steps(Scene of, double step, int steps)
      : scene(std::move(of)), method(tight()), dt(step), simulation(scene, method, dt, steps) {}
  static Method tight() {
    Method method = test::fixed_method("log", 1);
    method.step_solver.tol_velocity = 1e-11;
    return method;
  }
  void go(int steps) {
    StepObserver observer;
    for (int i = 0; i < steps; ++i) {
      const StepReport report = simulation.step(observer);
      ASSERT_EQ(report.status, StepStatus::converged) << report.detail;
    }
  }
};

TEST(Pull, carries_a_weight_behind_its_pose) {
  Steps run(pulled_particle(Vec3d(0.3, 0, 0.1)), 0.01, 1000);
  run.go(1000);
  const Positions& x = run.simulation.history().x;
  EXPECT_NEAR(x(0, 0), 0.3 * 10, 1e-6);  // it swings, damped by the integrator
  EXPECT_NEAR(x(2, 0), 100 + 0.1 * 10 - 0.2 * 10 / 50, 1e-6) << "m g/k below";
  EXPECT_NEAR(run.simulation.history().v(2, 0), 0.1, 1e-6);
}

TEST(Pull, lets_go_when_its_stiffness_ends) {
  Scene scene = pulled_particle(Vec3d::Zero());
  scene.pulls[0].factors = {{1, 1}, {1.005, 0}};
  Steps run(std::move(scene), 0.01, 300);
  run.go(100);
  const double at_rest = run.simulation.history().x(2, 0);
  run.go(50);
  const double speed = run.simulation.history().v(2, 0);
  run.go(20);
  EXPECT_NEAR(run.simulation.history().v(2, 0) - speed, -10 * 0.2, 1e-9) << "it falls freely";
  EXPECT_LT(run.simulation.history().x(2, 0), at_rest - 0.5);
}

TEST(Pull, acts_from_hold_to_release_and_lets_go_with_the_velocity_that_there_is) {
  Scene scene = pulled_particle(Vec3d(0.5, 0, 0));
  scene.gravity.setZero();
  scene.pulls[0].span = {0.1, 3};
  Steps run(std::move(scene), 0.01, 400);
  run.go(10);
  EXPECT_EQ(run.simulation.history().x(0, 0), 0) << "its motion has begun, the pull has not";
  run.go(1);
  EXPECT_GT(run.simulation.history().x(0, 0), 1e-3);
  run.go(300 - 11);
  const Vec3d x = run.simulation.history().x.col(0), v = run.simulation.history().v.col(0);
  EXPECT_NEAR(v[0], 0.5, 0.05) << "it follows by then";
  run.go(50);
  EXPECT_LT((run.simulation.history().v.col(0) - v).norm(), 1e-9) << "free";
  EXPECT_LT((run.simulation.history().x.col(0) - x - 0.5 * v).norm(), 1e-9);
}

constexpr double c_n = 0.6, c_t = 0.15, density = 0.3;

/// A sheet that is free in the air.
Scene sheet(const Vec3d& gravity, const Vec3d& velocity) {
  SceneBuilder builder("sheet", false, gravity, "test");
  BodySpec cloth = test::cloth_spec(3, 0, 0.001);
  cloth.velocity = velocity;
  builder.add_body(cloth);
  Scene scene = builder.finish();
  scene.air.normal = c_n;
  scene.air.tangential = c_t;
  return scene;
}

double speed_after(double time, double dt) {
  const int steps = static_cast<int>(std::lround(time / dt));
  Steps run(sheet(Vec3d(0, 0, -10), Vec3d::Zero()), dt, steps);
  run.go(steps);
  return -run.simulation.history().v.row(2).mean();
}

TEST(AirDrag, ends_at_the_closed_form_whatever_the_time_step) {
  const double terminal = density * 10 / c_n;
  for (const double dt : {0.04, 0.01}) EXPECT_NEAR(speed_after(12, dt), terminal, 1e-8 * terminal);
  const double exact = terminal * (1 - std::exp(-c_n / density * 0.4));
  const double coarse = speed_after(0.4, 0.04) - exact, fine = speed_after(0.4, 0.01) - exact;
  EXPECT_GT(std::abs(coarse), 0.01 * exact);
  EXPECT_NEAR(coarse / fine, 4, 0.5) << "first order, as the integrator is";
}

TEST(AirDrag, takes_what_slides_along_its_plane_with_the_other_coefficient) {
  Steps run(sheet(Vec3d::Zero(), Vec3d(2, 0, 0)), 0.01, 100);
  run.go(100);
  EXPECT_NEAR(run.simulation.history().v.row(0).mean(), 2 * std::pow(1 + c_t / density * 0.01, -100), 1e-8);
}

TEST(AirDrag, carries_a_sheet_with_a_wind_that_changes) {
  Scene scene = sheet(Vec3d::Zero(), Vec3d::Zero());
  scene.air.wind_keys = {{0, Vec3d(0, 0, 0)}, {1, Vec3d(0, 0, 3)}};
  Steps run(std::move(scene), 0.01, 1500);
  double expected = 0;  // v (1 + c h) = v_n + c h w(t)
  for (int i = 1; i <= 50; ++i) {
    const double ch = c_n / density * 0.01;
    expected = (expected + ch * 3 * i * 0.01) / (1 + ch);
  }
  run.go(50);
  EXPECT_NEAR(run.simulation.history().v.row(2).mean(), expected, 1e-8);
  run.go(1450);
  EXPECT_NEAR(run.simulation.history().v.row(2).mean(), 3, 1e-8);
}

/// Speed after one second, m/s, of what began with 2 m/s along x.
double damped_speed(Scene scene, const std::string& integrator, double dt) {
  scene.gravity.setZero();
  scene.v0.row(0).setConstant(2);
  Method method = test::fixed_method("log", 1, integrator);
  method.step_solver.tol_velocity = 1e-11;
  const int steps = static_cast<int>(std::lround(1 / dt));
  Simulation simulation(scene, method, dt, steps);
  StepObserver observer;
  for (int i = 0; i < steps; ++i) {
    EXPECT_EQ(simulation.step(observer).status, StepStatus::converged);
  }
  return simulation.history().v(0, 0);
}

TEST(VelocityDamping, leaves_the_same_part_whatever_the_time_step) {
  Scene far = test::particle_over_plane(0.2, 100, 0.01);
  far.damping = {0.3, 1e-3};
  Scene near = test::particle_over_plane(0.2, 0.009, 0.01);
  near.damping = far.damping;
  for (const double dt : {0.1, 0.01}) {
    for (const char* integrator : {"implicit_euler", "newmark"}) {
      EXPECT_NEAR(damped_speed(far, integrator, dt), 2 * 0.3, 1e-9) << integrator;
    }
    EXPECT_NEAR(damped_speed(near, "implicit_euler", dt), 2 * 1e-3, 1e-9);
  }
  near.damping.near_obstacles.reset();
  EXPECT_NEAR(damped_speed(near, "implicit_euler", 0.1), 2 * 0.3, 1e-9);
  near.damping.near_obstacles = 1e-3;
  near.offset = {-1};  // the same distance of a surface that begins farther off
  EXPECT_NEAR(damped_speed(near, "implicit_euler", 0.1), 2 * 0.3, 1e-9);
}

TEST(HalfGravity, falls_with_half_of_g) {
  Scene scene = test::particle_over_plane(0.2, 100, 0.01);
  Method method = test::fixed_method("log", 1, "half_gravity");
  method.step_solver.tol_velocity = 1e-11;
  Simulation simulation(scene, method, 0.01, 100);
  StepObserver observer;
  for (int i = 0; i < 100; ++i) ASSERT_EQ(simulation.step(observer).status, StepStatus::converged);
  EXPECT_NEAR(simulation.history().v(2, 0), -10 / 2.0, 1e-9);
}

/// Two particles far from each other and from everything, without weight.
Scene two_particles() {
  Scene scene = test::particle_over_plane(0.2, 100, 0.01);
  scene.gravity.setZero();
  scene.bodies = {{"pair", 0, 2}};
  scene.rest.setZero(3, 2);
  scene.rest.row(2).setConstant(100);
  scene.rest(0, 1) = 3;
  scene.x0 = scene.rest;
  scene.v0 = Positions::Zero(3, 2);
  scene.mass = {0.2, 0.6};
  scene.body = {0, 0};
  scene.d_hat = {0.01, 0.01};
  scene.offset = {0, 0};
  scene.surface_vertices = {0, 1};
  return scene;
}

TEST(Stitch, draws_two_together_as_the_reduced_mass_says) {
  Scene scene = two_particles();
  scene.stitches = {{{0, 1}}, {8}, {0}};
  const double dt = 0.01, mass = 0.2 * 0.6 / 0.8;
  double distance = 3, speed = 0;
  for (int i = 0; i < 100; ++i) {  // implicit Euler of one oscillator
    speed = (speed - dt * 8 / mass * distance) / (1 + dt * dt * 8 / mass);
    distance += dt * speed;
  }
  Steps run(std::move(scene), dt, 100);
  run.go(100);
  const Positions& x = run.simulation.history().x;
  ASSERT_GT(std::abs(distance - 3), 1);
  EXPECT_NEAR(x(0, 1) - x(0, 0), distance, 1e-8);
  EXPECT_NEAR(0.2 * x(0, 0) + 0.6 * x(0, 1), 0.6 * 3, 1e-9) << "the centre of mass stays";
}

TEST(Inflation, holds_a_solid_at_the_stretch_at_which_its_stress_is_the_pressure) {
  SceneBuilder builder("cube", false, Vec3d::Zero(), "test");
  BodySpec cube;
  cube.name = "cube";
  cube.mesh = solid_box_mesh({2, 2, 2}, Vec3d(0.4, 0.4, 0.4));
  cube.mesh.vertices.colwise() += Vec3d(5, 0, 3);
  cube.material.solid_density = 10;
  cube.material.solid_youngs = 1000;
  cube.material.solid_poisson = 0.3;
  cube.material.solid_model = "corotational";
  cube.d_hat = 1e-3;
  cube.pressure = 30;
  builder.add_body(cube);
  Steps run(builder.finish(), 10, 40);  // long steps of implicit Euler: at rest in the end
  run.go(40);
  // sigma of each axis: (2 mu + 3 lambda)(s - 1) per rest area = p s^2
  const double mu = 1000 / 2.6, lambda = 300 / (1.3 * 0.4), k = 2 * mu + 3 * lambda, p = 30;
  const double s = (k - std::sqrt(k * k - 4 * p * k)) / (2 * p);
  ASSERT_GT(s, 1.01);
  const Positions& x = run.simulation.history().x;
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR((x.row(axis).maxCoeff() - x.row(axis).minCoeff()) / 0.4, s, 1e-7);
  }
}

TEST(Gravity, follows_its_keys) {
  Scene scene = test::particle_over_plane(0.2, 100, 0.01);
  scene.gravity_keys = {{0.1, Vec3d(0, 0, -10)}, {0.2, Vec3d(2, 0, 10)}};
  scene.gravity = scene.gravity_keys[0].value;
  Steps run(std::move(scene), 0.01, 30);
  Vec3d expected = Vec3d::Zero();
  for (int i = 1; i <= 30; ++i) {
    const double f = std::clamp((i * 0.01 - 0.1) / 0.1, 0.0, 1.0);
    expected += 0.01 * Vec3d(2 * f, 0, -10 + 20 * f);
  }
  run.go(30);
  EXPECT_LT((run.simulation.history().v.col(0) - expected).norm(), 1e-9);
}

}  // namespace
}  // namespace bb::driven_test
