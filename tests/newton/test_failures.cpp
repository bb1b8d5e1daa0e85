// Failures are results: named, with the feasible state kept.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/math/error.hpp"
#include "core/step_solvers/registry.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::failures_test {
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
  EXPECT_GT(report.contact_overload.value, 1);
  EXPECT_GT(report.gap_min_iterates_m.value, 0);
}

TEST(Failures, the_capacity_is_that_of_the_largest_force_wherever_it_peaks) {
  // cubic on the squared gap: no force at contact, the largest, 1.145 kappa d_hat = 0.1145
  // N, at d_hat/sqrt(5)
  Scene scene = test::particle_over_plane(0.2, 0.0099, 0.01);
  Method method = test::fixed_method("cubic", 10);
  method.contact.argument = Argument::squared_gap;
  Simulation simulation(scene, method, 0.01, 100);
  StepObserver observer;
  StepReport report;
  for (int i = 0; i < 100 && report.status == StepStatus::converged; ++i) report = simulation.step(observer);
  ASSERT_TRUE(report.contact_overload.finite());
  EXPECT_GT(report.contact_overload.value, 2 / 0.1145 - 1);  // of the weight alone; the fall adds to it
  EXPECT_LT(report.contact_overload.value, 10 * 2 / 0.1145);
}

/// b = (d_hat - d)^2 d_hat/(1 m), a shape that is not d_hat^2 times a function of d/d_hat.
void steep(void*, std::size_t n, const double* d, const double* d_hat, double* b, double* db, double* d2b) {
  for (std::size_t i = 0; i < n; ++i) {
    const double depth = std::max(0.0, d_hat[i] - d[i]);
    b[i] = depth * depth * d_hat[i];
    db[i] = -2 * depth * d_hat[i];
    d2b[i] = depth > 0 ? 2 * d_hat[i] : 0;
  }
}

TEST(Failures, the_capacity_is_asked_of_the_shape_at_the_d_hat_of_the_row) {
  // capacity 2 kappa d_hat^2/(1 m) = 0.2 N against 2 N of weight
  Scene scene = test::particle_over_plane(0.2, 0.0099, 0.01);
  Method method = test::fixed_method("cubic", 1000);
  method.contact.shape = Shape{"steep", "", 1, false, steep, nullptr, nullptr};
  Simulation simulation(scene, method, 0.01, 100);
  StepObserver observer;
  StepReport report;
  for (int i = 0; i < 100 && report.status == StepStatus::converged; ++i) report = simulation.step(observer);
  ASSERT_NE(report.status, StepStatus::converged);
  EXPECT_EQ(report.contacts.obstacle, 1U);
  EXPECT_GT(report.contact_overload.value, 2 / 0.2 - 1);  // of the weight alone; the fall adds to it
}

TEST(Failures, the_log_barrier_has_no_capacity) {
  Scene scene = test::particle_over_plane(0.2, 0.0099, 0.01);
  Method method = test::fixed_method("log", 1);
  Simulation simulation(scene, method, 0.01, 100);
  StepObserver observer;
  for (int i = 0; i < 100; ++i) {
    const StepReport report = simulation.step(observer);
    ASSERT_EQ(report.status, StepStatus::converged) << i << " " << report.detail;
    EXPECT_FALSE(report.contact_overload.finite());
  }
}

/// A cloth hung from one side in a plane that gravity lies in, stretched by a single pull: the end of its
/// last converged step or of the one that failed.
StepReport hang(double k_s, int steps) {
  SceneBuilder builder("hung cloth", false, Vec3d(0, -10, 0), "test");
  BodySpec spec = test::cloth_spec(5, 0, 0.001);
  spec.material.youngs = 1;  // carries nothing
  spec.material.limit = StrainLimitSpec{0.01, 0.01};
  PinSpec pin;
  for (int v = 0; v < 25; ++v) {
    if (spec.mesh.vertices(1, v) > spec.mesh.vertices.row(1).maxCoeff() - 1e-9) pin.indices.push_back(v);
  }
  spec.pins = {pin};
  builder.add_body(spec);
  Scene scene = builder.finish();
  Method method = test::fixed_method("cubic", 1);
  method.limit_stiffness = test::fixed_limit(k_s);
  Simulation simulation(scene, method, 0.01, steps);
  StepObserver observer;
  StepReport report;
  for (int i = 0; i < steps && report.status == StepStatus::converged; ++i)
    report = simulation.step(observer);
  return report;
}

// The hem pulls row after row: inside, the forces of neighbours cancel and only their sum meets the weight.
TEST(Failures, a_cloth_too_heavy_for_its_limit_is_an_overload_of_the_limit) {
  const StepReport weak = hang(20, 40);  // 2 k_s width = 0.4 N/m against 3 N/m of weight
  EXPECT_EQ(weak.status, StepStatus::step_collapse);
  EXPECT_GT(weak.limit_overload.value, 2);
  EXPECT_EQ(weak.contact_overload.value, 0);
  EXPECT_GT(weak.max_stretch.value, 0.0199);

  const StepReport strong = hang(2e4, 40);
  EXPECT_EQ(strong.status, StepStatus::converged);
  EXPECT_GT(strong.limit_load_max_N_per_m.value, 2);  // it does carry the weight
}

/// Every element is stretched alike, and the forces of neighbours cancel: only the Newton model sees that
/// the middle has to stop both halves, at 4/s/0.01 s on 0.3 kg/m^2 a tension of up to 15 N/m against 2 k_s
/// width = 6.
TEST(Failures, a_load_that_neighbours_share_is_an_overload_of_the_limit) {
  SceneBuilder builder("cloth that flies apart", false, Vec3d::Zero(), "test");
  BodySpec spec = test::cloth_spec(9, 0, 0.001);
  spec.material.youngs = 1;
  spec.material.limit = StrainLimitSpec{0.01, 0.01};
  builder.add_body(spec);
  Scene scene = builder.finish();
  const double middle = scene.x0.row(0).mean();
  scene.v0.row(0) = 4 * (scene.x0.row(0).array() - middle);
  Method method = test::fixed_method("cubic", 1);
  method.limit_stiffness = test::fixed_limit(300);
  Simulation simulation(scene, method, 0.01, 1);
  StepObserver observer;
  const StepReport report = simulation.step(observer);
  EXPECT_EQ(report.status, StepStatus::step_collapse);
  EXPECT_GT(report.limit_overload.value, 1);
}

TEST(Failures, the_iteration_cap_is_not_convergence) {
  Scene scene = test::particle_over_plane(0.2, 0.005, 0.01);
  Method method = test::fixed_method("log", 200);
  method.step_solver.max_iterations = 1;
  Simulation simulation(scene, method, 0.01, 1);
  StepObserver observer;
  const StepReport report = simulation.step(observer);
  EXPECT_EQ(report.status, StepStatus::iteration_cap);
  EXPECT_EQ(report.newton_iterations, 1);
}

TEST(Failures, a_matrix_without_inertia_or_stiffness_is_named) {
  Scene scene = test::particle_over_plane(0.2, 1, 0.01);
  Method method = test::fixed_method("log", 1, "quasi_static");
  Simulation simulation(scene, method, 0.01, 1);
  StepObserver observer;
  const StepReport report = simulation.step(observer);
  EXPECT_EQ(report.status, StepStatus::linear_failed);
  EXPECT_EQ(report.detail, "matrix_indefinite: no positive pivot at vertex 0");
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
}  // namespace bb::failures_test
