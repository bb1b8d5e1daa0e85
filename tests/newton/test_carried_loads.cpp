// Friction with step solvers whose multipliers are those of one step: its loads are what contacts carried at the end of the step before, or,
// renewed, what they carry at the end of this one, and how often it is renewed does not depend on how often multipliers are.
#include <gtest/gtest.h>

#include "core/base/archive/archive.hpp"
#include "core/step_solvers/registry.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::carried_loads_test {
namespace {

constexpr double d_hat = 0.01, mass = 0.2, mu = 0.3, dt = 0.01;  // m, kg, 1, s

Method method_of(const std::string& solver, int lag_iterations) {
  Method method = test::fixed_method("quadratic", 50);
  choose_step_solver(method, solver);
  method.step_solver.tol_velocity = 1e-9;
  method.step_solver.max_iterations = 500;
  method.friction.mu = mu;
  method.friction.eps_v = 1e-4;
  method.friction.lag_iterations = lag_iterations;
  fit_terms(method);
  return method;
}

/// It comes down at 1 m/s and slides at 1 m/s, and nothing else acts on it.
Scene thrown() {
  Scene scene = test::particle_over_plane(mass, 0.5 * d_hat, d_hat);
  scene.gravity.setZero();
  scene.v0 = test::one_point(1, 0, -1);
  return scene;
}

std::vector<double> speeds(const Scene& scene, int lag_iterations, int steps) {
  Method method = method_of("augmented_lagrangian", lag_iterations);
  Simulation simulation(scene, method, dt, steps);
  StepObserver none;
  std::vector<double> out;
  for (int i = 0; i < steps; ++i) {
    const StepReport report = simulation.step(none);
    EXPECT_EQ(report.status, StepStatus::converged) << report.detail;
    if (i == 0) {
      EXPECT_GT(report.solver.values.at("al_updates"), 2);
    }
    out.push_back(simulation.history().v(0, 0));
  }
  return out;
}

// The first step stops it at the plane, 5 mm below: of 1 m/s it takes 0.5, in the second step the rest.
TEST(CarriedLoads, AreThoseOfTheEndOfTheStepBefore) {
  const std::vector<double> once = speeds(thrown(), 1, 3);
  EXPECT_NEAR(once[0], 1, 1e-9);             // no contact had a load at the start
  EXPECT_NEAR(once[1], 1 - mu * 0.5, 1e-4);  // that of the first step
  EXPECT_NEAR(once[2], 1 - mu * (0.5 + 0.5), 1e-4);
}

TEST(CarriedLoads, AreRenewedWithinAStepHoweverOftenMultipliersAre) {
  for (const int lag_iterations : {2, 4}) {
    const std::vector<double> renewed = speeds(thrown(), lag_iterations, 3);
    EXPECT_NEAR(renewed[0], 1 - mu * 0.5, 1e-4) << lag_iterations;
    EXPECT_NEAR(renewed[1], 1 - mu * (0.5 + 0.5), 1e-4) << lag_iterations;
    EXPECT_NEAR(renewed[2], renewed[1], 1e-4) << lag_iterations;
  }
}

// Beside a barrier too: one that is so soft that multipliers carry half of the weight.
TEST(CarriedLoads, AreKeptWithMultipliersBesideABarrier) {
  Scene scene = test::particle_over_plane(mass, 0.2 * d_hat, d_hat);
  scene.v0(0, 0) = 1;
  Method method = method_of("al_barrier", 1);
  Simulation simulation(scene, method, dt, 20);
  StepObserver none;
  double most = 0;
  for (int i = 0; i < 20; ++i) {
    const StepReport report = simulation.step(none);
    ASSERT_EQ(report.status, StepStatus::converged) << report.detail;
    most = std::max(most, report.solver.values.at("al_barrier_force_N"));
  }
  EXPECT_GT(most, 0.1);
  EXPECT_NEAR(simulation.history().v(0, 0), 1 - mu * 10 * 20 * dt, 0.05 * mu * 10 * 20 * dt);
}

TEST(CarriedLoads, GoIntoAnArchive) {
  const Scene scene = thrown();
  for (const char* solver : {"augmented_lagrangian", "al_barrier"}) {
    Method method = method_of(solver, 1), other = method_of(solver, 1);
    Simulation first(scene, method, dt, 4), again(scene, other, dt, 4);
    StepObserver none;
    first.step(none);
    Archive kept;
    first.keep(kept);
    Archive read(kept.bytes());
    again.keep(read);
    first.step(none), again.step(none);
    EXPECT_LT(first.history().v(0, 0), 0.95) << solver;
    EXPECT_EQ(first.history().x, again.history().x) << solver;
  }
}

}  // namespace
}  // namespace bb::carried_loads_test
