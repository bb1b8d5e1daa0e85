// The projected-Newton step: quadratics in one step, energy never rises, momentum, determinism, reuse.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <cmath>

#include "core/step_solvers/registry.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::line_search_test {
namespace {

Scene cloth_on_sphere(int n) {
  SceneBuilder builder("cloth on sphere", false, Vec3d(0, 0, -9.81), "test");
  BodySpec spec = test::cloth_spec(n, 0, 0.01);
  spec.material.bending = 1e-4;
  spec.material.limit = StrainLimitSpec{0.025, 0.025};
  spec.velocity = Vec3d(0, 0, -1);
  builder.add_body(spec);
  Obstacle sphere;
  sphere.name = "sphere";
  sphere.kind = ObstacleKind::sphere;
  sphere.point = Vec3d(0.003, 0.002, -0.312);
  sphere.radius = 0.3;
  builder.add_obstacle(sphere);
  return builder.finish();
}

/// Asserts on every iteration that the accepted energy went down, up to what is called rounding.
class EnergyWatch final : public StepObserver {
 public:
  void on_iteration(const IterationReport& report) override {
    if (!report.rounding_accepts) {
      EXPECT_LE(report.energy_change_J.value, 0) << report.step << "/" << report.iteration;
    }
    if (report.rounding_accepts) {  // no descent by Armijo's measure
      EXPECT_GT(report.energy_change_J.value, -1e-4 * report.alpha * 2 * report.decrement_J)
          << report.step << "/" << report.iteration;
      ++roundings;
    }
    descents += report.energy_change_J.value < 0;
    contacts += report.contacts.total();
    stretched += report.max_stretch.value > 0.025;
  }
  int descents = 0, stretched = 0, roundings = 0;
  std::size_t contacts = 0;
};

TEST(LineSearch, energy_falls_in_every_iteration_of_a_draping_cloth) {
  Scene scene = cloth_on_sphere(8);
  for (const Shape& shape : all_shapes()) {
    Method method = test::fixed_method(shape.name, 400);
    method.limit_stiffness = test::fixed_limit(2e4);
    Simulation simulation(scene, method, 0.01, 15);
    EnergyWatch watch;
    for (int i = 0; i < 15; ++i) {
      const StepReport report = simulation.step(watch);
      ASSERT_EQ(report.status, StepStatus::converged) << shape.name << " step " << i << " " << report.detail;
      EXPECT_EQ(report.gap_min_m.finite(), report.contacts.total() > 0);
      if (report.contacts.total() > 0) {
        EXPECT_GT(report.gap_min_m.value, 0);
      }
      EXPECT_LT(report.max_stretch.value, 0.05);
    }
    EXPECT_GT(watch.contacts, 20U) << shape.name;
    EXPECT_GT(watch.descents, 15) << shape.name;
  }
}

TEST(LineSearch, free_fall_of_a_cloth_is_one_quadratic) {
  SceneBuilder builder("falling cloth", false, Vec3d(0, 0, -9.81), "test");
  builder.add_body(test::cloth_spec(5, 10, 0.001));
  Scene scene = builder.finish();
  Method method = test::fixed_method("log", 1);
  Simulation simulation(scene, method, 0.01, 3);
  StepObserver observer;
  for (int i = 0; i < 3; ++i) {
    const StepReport report = simulation.step(observer);
    EXPECT_EQ(report.status, StepStatus::converged);
    EXPECT_LE(report.newton_iterations, 2);
  }
  const double fallen = simulation.history().x(2, 7) - scene.x0(2, 7);
  EXPECT_NEAR(fallen, -9.81 * 1e-4 * (1 + 2 + 3), 1e-12);
}

// Newton doubles a gap far below its equilibrium by directions as short as the gap: here far below the tolerance.
TEST(LineSearch, a_short_direction_next_to_an_unbounded_barrier_is_no_end_of_a_step) {
  const Scene scene = test::particle_over_plane(0.1, 1e-10, 1e-3);
  for (const char* shape : {"log", "log_squared", "two_stage", "minimax"}) {
    const auto gap_at = [&](double tol_velocity) {
      Method method = test::fixed_method(shape, 1000);
      method.step_solver.tol_velocity = tol_velocity;
      Simulation simulation(scene, method, 0.01, 1);
      StepObserver observer;
      const StepReport report = simulation.step(observer);
      EXPECT_EQ(report.status, StepStatus::converged) << shape;
      EXPECT_EQ(report.contacts.obstacle, 1) << shape;
      return report.gap_min_m.value;
    };
    const double loose = 1e-6, strict = 1e-10;
    EXPECT_GT(gap_at(loose), 1e-5) << shape;
    EXPECT_NEAR(gap_at(loose), gap_at(strict), loose * 0.01) << shape;
  }
}

TEST(LineSearch, an_unchanged_pattern_is_not_analysed_again) {
  SceneBuilder builder("falling cloth", false, Vec3d(0, 0, -9.81), "test");
  builder.add_body(test::cloth_spec(6, 10, 0.001));
  Scene scene = builder.finish();
  Method method = test::fixed_method("log", 1);
  Simulation simulation(scene, method, 0.01, 2);
  StepObserver observer;
  const StepReport first = simulation.step(observer), second = simulation.step(observer);
  EXPECT_EQ(first.analyses, 1);
  EXPECT_EQ(second.analyses, 0);
  EXPECT_GE(second.factorizations, 1);
}

TEST(LineSearch, threads_change_no_bit) {
  Scene scene = cloth_on_sphere(10);
  const auto final_state = [&scene](std::size_t threads) {
    const oneapi::tbb::global_control control(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    Method method = test::fixed_method("cubic", 2000);
    method.limit_stiffness = test::fixed_limit(2e4);
    Simulation simulation(scene, method, 0.01, 10);
    StepObserver observer;
    std::size_t contacts = 0;
    for (int i = 0; i < 10; ++i) contacts += simulation.step(observer).contacts.total();
    EXPECT_GT(contacts, 10U);
    return simulation.history().x;
  };
  const Positions one = final_state(1), two = final_state(2);
  EXPECT_TRUE((one.array() == two.array()).all());
}

/// The first iteration whose step a bound cut short.
class CapWatch final : public StepObserver {
 public:
  void on_iteration(const IterationReport& report) override {
    if (report.alpha_ccd < 1 && capped.alpha == 0 && report.line_search_trials == 1) capped = report;
  }
  IterationReport capped;
};

TEST(LineSearch, takes_its_fraction_of_a_binding_bound) {
  for (const double fraction : {0.8, 0.5}) {
    Scene scene = test::particle_over_plane(0.2, 0.02, 0.01);
    scene.v0(2, 0) = -5;  // the prediction is far below the plane
    Method method = test::fixed_method("log", 100);
    method.step_solver.parameters["cap_fraction"] = fraction;
    Simulation simulation(scene, method, 0.01, 1);
    CapWatch watch;
    ASSERT_EQ(simulation.step(watch).status, StepStatus::converged);
    ASSERT_GT(watch.capped.alpha, 0);
    EXPECT_DOUBLE_EQ(watch.capped.alpha, fraction * watch.capped.alpha_ccd);
  }
}

/// The first iteration of a step.
class FirstIteration final : public StepObserver {
 public:
  void on_iteration(const IterationReport& report) override {
    if (report.iteration == 0) first = report;
  }
  IterationReport first;
};

/// E of a falling particle is a quadratic: a step of alpha changes it by -(alpha - alpha^2/2) D, where D is
/// the decrement -g . dx. Armijo requires a fall of armijo alpha D, so alpha <= 2 (1 - armijo).
TEST(LineSearch, takes_the_first_halved_step_whose_fall_is_armijos_share_of_the_slope) {
  struct Case {
    double armijo, alpha;
    int trials;
  };
  for (const char* solver : {"line_search", "article_literal"}) {
    for (const Case& c : {Case{0.4, 1, 1}, Case{0.6, 0.5, 2}, Case{0.9, 0.125, 4}}) {
      Scene scene = test::particle_over_plane(0.2, 1, 0.01);
      Method method = test::fixed_method("log", 1);
      choose_step_solver(method, solver);
      method.step_solver.parameters["armijo"] = c.armijo;
      Simulation simulation(scene, method, 0.01, 1);
      FirstIteration watch;
      simulation.step(watch);
      const double decrement = 2 * watch.first.decrement_J;
      ASSERT_GT(decrement, 0) << solver;
      EXPECT_EQ(watch.first.alpha, c.alpha) << solver << " " << c.armijo;
      EXPECT_EQ(watch.first.line_search_trials, c.trials) << solver << " " << c.armijo;
      EXPECT_FALSE(watch.first.rounding_accepts) << solver << " " << c.armijo;
      EXPECT_NEAR(watch.first.energy_change_J.value, -(c.alpha - c.alpha * c.alpha / 2) * decrement,
                  1e-5 * decrement)
          << solver << " " << c.armijo;
    }
  }
}

/// The article's own solver adds eps I to the matrix, eps = 1e-6 of its mean diagonal entry, all of
/// which are m/h^2.
TEST(LineSearch, the_articles_direction_is_that_of_its_own_matrix) {
  Scene scene = test::particle_over_plane(0.2, 1, 0.01);
  Method method = test::fixed_method("log", 1);
  choose_step_solver(method, "article_literal");
  const double dt = 0.01;
  Simulation simulation(scene, method, dt, 1);
  FirstIteration watch;
  simulation.step(watch);
  EXPECT_NEAR(watch.first.dx_inf_m / (10 * dt * dt) * (1 + 1e-6), 1, 1e-12);
}

/// The first iteration that the strain limit alone cuts short.
class StrainWatch final : public StepObserver {
 public:
  void on_iteration(const IterationReport& report) override {
    if (report.alpha_strain < 1 && report.alpha_ccd == 1 && capped.alpha == 0) capped = report;
  }
  IterationReport capped;
};

TEST(LineSearch, takes_its_fraction_of_a_binding_strain_bound_at_the_first_trial) {
  SceneBuilder builder("cloth that flies apart", false, Vec3d::Zero(), "test");
  BodySpec spec = test::cloth_spec(3, 0, 0.001);
  spec.material.limit = StrainLimitSpec{0.01, 0.01};
  builder.add_body(spec);
  Scene scene = builder.finish();
  scene.v0.row(0) = 10 * (scene.x0.row(0).array() - scene.x0.row(0).mean());
  Method method = test::fixed_method("log", 1);
  method.limit_stiffness = test::fixed_limit(300);
  Simulation simulation(scene, method, 0.01, 1);
  StrainWatch watch;
  simulation.step(watch);
  ASSERT_GT(watch.capped.alpha, 0);
  EXPECT_DOUBLE_EQ(watch.capped.alpha, 0.8 * watch.capped.alpha_strain);
  EXPECT_EQ(watch.capped.line_search_trials, 1);
}

/// Every |dx|_inf of a step.
class DirectionWatch final : public StepObserver {
 public:
  void on_iteration(const IterationReport& report) override { dx.push_back(report.dx_inf_m); }
  std::vector<double> dx;
};

TEST(LineSearch, stops_at_the_first_direction_that_is_slower_than_the_tolerance) {
  for (const double tolerance : {1e-3, 1e-7}) {
    Scene scene = test::particle_over_plane(0.2, 0.009, 0.01);
    scene.v0(2, 0) = -0.5;
    Method method = test::fixed_method("log", 200);
    method.step_solver.tol_velocity = tolerance;
    const double dt = 0.01;
    Simulation simulation(scene, method, dt, 1);
    DirectionWatch watch;
    ASSERT_EQ(simulation.step(watch).status, StepStatus::converged);
    ASSERT_GT(watch.dx.size(), 2U);
    EXPECT_LT(watch.dx.back() / dt, tolerance);
    watch.dx.pop_back();
    for (const double dx : watch.dx) EXPECT_GE(dx / dt, tolerance);
  }
}

/// A shape whose energy is a number in its first evaluation, that of the iterate, and in no trial.
void once(void* calls, std::size_t n, const double*, const double* d_hat, double* b, double* db,
          double* d2b) {
  const bool first = (*static_cast<int*>(calls))++ == 0;
  for (std::size_t i = 0; i < n; ++i) {
    b[i] = first ? 0 : std::nan("");
    db[i] = -d_hat[i];
    d2b[i] = 1;
  }
}

TEST(LineSearch, a_direction_without_any_decrease_is_a_failed_line_search_at_once) {
  for (const char* solver : {"line_search", "article_literal"}) {
    const Scene scene = test::particle_over_plane(0.2, 0.5, 1);
    Method method = test::fixed_method("cubic", 1);
    int calls = 0;
    method.contact.shape.batch_double = once;
    method.contact.shape.self = &calls;
    choose_step_solver(method, solver);
    Simulation simulation(scene, method, 0.01, 1);
    StepObserver observer;
    const StepReport report = simulation.step(observer);
    EXPECT_EQ(report.status, StepStatus::line_search_failed) << solver << " " << report.detail;
    EXPECT_EQ(report.newton_iterations, 1);
    EXPECT_EQ(simulation.history().x, scene.x0);
  }
}

TEST(LineSearch, accumulated_toi_reaches_the_same_state_without_contact) {
  SceneBuilder builder("falling cloth", false, Vec3d(0, 0, -9.81), "test");
  builder.add_body(test::cloth_spec(5, 10, 0.001));
  Scene scene = builder.finish();
  Method method = test::fixed_method("cubic", 1);
  choose_step_solver(method, "accumulated_toi");
  Simulation simulation(scene, method, 0.01, 3);
  StepObserver observer;
  for (int i = 0; i < 3; ++i) {
    const StepReport report = simulation.step(observer);
    EXPECT_EQ(report.status, StepStatus::converged);
    EXPECT_EQ(report.newton_iterations, 2);  // one free Newton step and the error-reduction pass
    EXPECT_EQ(report.dt_s, 0.01);
  }
  EXPECT_NEAR(simulation.history().x(2, 7) - scene.x0(2, 7), -9.81 * 1e-4 * 6, 1e-12);
}

TEST(LineSearch, accumulated_toi_drapes_without_touching) {
  Scene scene = cloth_on_sphere(8);
  Method method = test::fixed_method("cubic", 1);
  PolicyConfig policy;
  policy.name = "elasticity_inclusive";
  method.stiffness = make_policy(policy);
  method.limit_stiffness = test::elastic_limit();
  choose_step_solver(method, "accumulated_toi");
  Simulation simulation(scene, method, 0.01, 15);
  StepObserver observer;
  std::size_t contacts = 0;
  for (int i = 0; i < 15; ++i) {
    const StepReport report = simulation.step(observer);
    ASSERT_EQ(report.status, StepStatus::converged) << report.detail;
    contacts += report.contacts.total();
    EXPECT_EQ(report.gap_min_m.finite(), report.contacts.total() > 0);
    if (report.contacts.total() > 0) {
      EXPECT_GT(report.gap_min_m.value, 0);
    }
    EXPECT_LT(report.max_stretch.value, 0.05);
  }
  EXPECT_GT(contacts, 10U);
}

}  // namespace
}  // namespace bb::line_search_test
