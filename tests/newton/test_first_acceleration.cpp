// a_0 of Newmark's method: the forces at the start over the mass, without inertia.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/newton/small_scenes.hpp"

namespace bb::first_acceleration_test {
namespace {

constexpr double mass = 0.2, d_hat = 0.01, dt = 0.002;

/// a_0 of vertex v, read off the first step: x_1 = x_0 + h v_0 + h^2/4 (a_0 + a_1).
Vec3d start_acceleration(const Scene& scene, Method& method, int v) {
  Simulation simulation(scene, method, dt, 10);
  StepObserver observer;
  EXPECT_EQ(simulation.step(observer).status, StepStatus::converged);
  const History& end = simulation.history();
  return 4 / (dt * dt) * (end.x.col(v) - scene.x0.col(v) - dt * scene.v0.col(v)) - end.a.col(v);
}

TEST(FirstAcceleration, of_a_thrown_particle_is_gravity_whatever_its_velocity) {
  Scene scene = test::particle_over_plane(mass, 1, d_hat);
  scene.v0.col(0) = Vec3d(3, -2, 5);
  Method method = test::fixed_method("log", 1, "newmark");
  Simulation simulation(scene, method, dt, 10);
  StepObserver observer;
  for (int i = 0; i < 10; ++i) ASSERT_EQ(simulation.step(observer).status, StepStatus::converged);
  const double t = simulation.time();
  ASSERT_NEAR(t, 10 * dt, 1e-15);
  const Vec3d parabola = scene.x0.col(0) + t * scene.v0.col(0) + t * t / 2 * scene.gravity;
  EXPECT_LT((simulation.history().x.col(0) - parabola).norm(), 1e-12);
}

TEST(FirstAcceleration, holds_the_force_of_a_contact_that_is_there_at_the_start) {
  Scene scene = test::particle_over_plane(mass, 0.5 * d_hat, d_hat);
  scene.v0(2, 0) = -0.1;
  const double kappa = 300;
  Method method = test::fixed_method("quadratic", kappa, "newmark");
  const double push = kappa * 2 * (0.5 * d_hat) / mass;  // kappa |b'| / m
  ASSERT_GT(push, 1);
  EXPECT_NEAR(start_acceleration(scene, method, 0)[2], push - 10, 1e-3);
}

/// A spring of 1 m between a pinned and a free particle, stretched by a tenth.
TEST(FirstAcceleration, holds_elastic_forces_and_none_at_prescribed_vertices) {
  Scene scene = test::particle_over_plane(mass, 1, d_hat);
  scene.obstacles.clear();
  scene.bodies = {{"spring", 0, 2}};
  scene.rest.resize(3, 2);
  scene.rest << 0, 1, 0, 0, 0, 0;
  scene.x0 = scene.rest;
  scene.x0(0, 1) = 1.1;
  scene.v0 = Positions::Zero(3, 2);
  scene.v0(0, 1) = 1;
  scene.mass = {0, mass};
  scene.body = {0, 0};
  scene.d_hat = {d_hat, d_hat};
  scene.offset = {0, 0};
  scene.surface_vertices = {0, 1};
  scene.springs.edges = {{0, 1}};
  scene.springs.stiffness = {7};
  scene.motions.resize(1);
  scene.pins = {{0, 0}};
  Method method = test::fixed_method("log", 1, "newmark");
  const Vec3d a = start_acceleration(scene, method, 1);
  EXPECT_NEAR(a[0], -7 * 0.1 / mass, 1e-3);
  EXPECT_NEAR(a[2], -10, 1e-3);
  EXPECT_EQ(start_acceleration(scene, method, 0), Vec3d(Vec3d::Zero()));
}

/// A particle without weight that a spring of 3 N/m pulls 0.1 m up, from the time `hold` on.
Scene pulled_from(double hold) {
  Scene scene = test::particle_over_plane(mass, 1, d_hat);
  scene.gravity.setZero();
  scene.obstacles.clear();
  scene.motions.emplace_back();
  scene.motions[0].keyframes = {{0, Vec3d(0, 0, 0.1), 0, 1}};
  scene.pulls = {{{0}, 0, 3, {}, {hold}}};
  return scene;
}

TEST(FirstAcceleration, holds_a_pull_that_acts_from_the_start) {
  Method method = test::fixed_method("log", 1, "newmark");
  for (const double hold : {0.0, -std::numeric_limits<double>::infinity()}) {
    EXPECT_NEAR(start_acceleration(pulled_from(hold), method, 0)[2], 3 * 0.1 / mass, 1e-3) << hold;
  }
  EXPECT_EQ(start_acceleration(pulled_from(5 * dt), method, 0)[2], 0) << "not yet";
}

/// The force jumps in the middle of the run: the order stays 2.
TEST(FirstAcceleration, is_taken_anew_where_a_pull_begins) {
  Method method = test::fixed_method("log", 1, "newmark");
  method.step_solver.tol_velocity = 1e-10;
  const double begin = 0.04, end = 0.2, exact = 0.1 * (1 - std::cos(std::sqrt(3 / mass) * (end - begin)));
  double coarse = 0;
  for (const int steps : {10, 20, 40, 80}) {
    const Scene scene = pulled_from(begin);
    Simulation simulation(scene, method, end / steps, steps);
    StepObserver observer;
    for (int i = 0; i < steps; ++i) ASSERT_EQ(simulation.step(observer).status, StepStatus::converged);
    const double error = std::abs(simulation.history().x(2, 0) - scene.x0(2, 0) - exact);
    ASSERT_GT(error, 1e-8);
    if (steps > 10) {
      EXPECT_NEAR(coarse / error, 4, 0.2) << steps;
    }
    coarse = error;
  }
}

}  // namespace
}  // namespace bb::first_acceleration_test
