// Failures are results: named, with the feasible state kept.
#include <gtest/gtest.h>

#include "core/math/error.hpp"
#include "core/newton/step_solver.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb {
namespace {

TEST(Failures, a_load_over_the_capacity_ends_the_step_and_is_measured) {
  // cubic: capacity 2 kappa d_hat = 0.2 N against 2 N of weight.
  Scene scene = test::particle_over_plane(0.2, 0.0099, 0.01);
  Method method = test::fixed_method("cubic", 10);
  Simulation simulation(scene, method, 0.01, 100);
  StepObserver observer;
  StepReport report;
  for (int i = 0; i < 100 && report.status == StepStatus::converged; ++i) report = simulation.step(observer);
  EXPECT_NE(report.status, StepStatus::converged);
  EXPECT_GT(report.overload, 1);
  EXPECT_GT(report.gap_min, 0);
}

TEST(Failures, the_log_barrier_has_no_capacity) {
  Scene scene = test::particle_over_plane(0.2, 0.0099, 0.01);
  Method method = test::fixed_method("log", 1);
  Simulation simulation(scene, method, 0.01, 100);
  StepObserver observer;
  for (int i = 0; i < 100; ++i) {
    const StepReport report = simulation.step(observer);
    ASSERT_EQ(report.status, StepStatus::converged) << i << " " << report.detail;
    EXPECT_EQ(report.overload, 0);
  }
}

TEST(Failures, the_iteration_cap_is_not_convergence) {
  Scene scene = test::particle_over_plane(0.2, 0.005, 0.01);
  Method method = test::fixed_method("log", 200);
  method.step_solver.max_iterations = 1;
  Simulation simulation(scene, method, 0.01, 1);
  StepObserver observer;
  const StepReport report = simulation.step(observer);
  EXPECT_EQ(report.status, StepStatus::iteration_cap);
  EXPECT_EQ(report.iterations, 1);
}

TEST(Failures, a_matrix_without_inertia_or_stiffness_is_named) {
  Scene scene = test::particle_over_plane(0.2, 1, 0.01);
  Method method = test::fixed_method("log", 1, "quasi_static");
  Simulation simulation(scene, method, 0.01, 1);
  StepObserver observer;
  const StepReport report = simulation.step(observer);
  EXPECT_EQ(report.status, StepStatus::linear_failed);
  EXPECT_EQ(report.detail, to_string(LinearStatus::matrix_indefinite));
}

TEST(Failures, an_unknown_step_solver_lists_the_known_ones) {
  StepSolverOptions options;
  options.name = "newton";
  try {
    make_step_solver(options);
    FAIL() << "no error";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("accumulated_toi"), std::string::npos);
  }
}

}  // namespace
}  // namespace bb
