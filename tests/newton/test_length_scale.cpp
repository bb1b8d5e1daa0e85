// No step solver has a length of its own: a scene whose lengths are all 2^-10 times as long, with units to match, takes the same steps,
// bit for bit, and ends 2^-10 times as far.
#include <gtest/gtest.h>

#include <cmath>

#include "core/step_solvers/registry.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::length_scale_test {
namespace {

constexpr double dt = 0.01;

/// A net of springs that falls onto a plane it is tilted to; all lengths times L: masses and stiffnesses (N/m) stay.
Scene net(double L) {
  BodySpec spec = test::cloth_spec(4, 0, 0.01 * L);
  for (int v = 0; v < 16; ++v) spec.mesh.vertices(2, v) = 0.011 + 0.01 * spec.mesh.vertices(0, v) + 0.005;
  spec.mesh.vertices *= L;
  spec.material.model = "none";
  spec.material.springs = 50;
  spec.material.density = 0.3 / (L * L);
  spec.velocity = Vec3d(0.3, 0, -1) * L;
  SceneBuilder builder("net", false, Vec3d(0, 0, -10) * L, "test");
  Obstacle floor;
  floor.name = "floor";
  builder.add_obstacle(floor);
  builder.add_body(spec);
  return builder.finish();
}

struct Ran {
  Positions x;
  int iterations = 0;
  std::size_t contacts = 0;
};

Ran run(const std::string& solver, double L, double speed = 0) {
  Scene scene = net(L);
  if (speed > 0) scene.v0.row(0).array() += speed * L;
  Method method = test::fixed_method(solver == "penalty" ? "quadratic" : "log", 20);
  choose_step_solver(method, solver);
  method.step_solver.tol_velocity = 1e-4 * L;
  method.step_solver.max_iterations = 400;
  method.step_solver.saddle = SaddleRule::ignore;
  ParameterMap& own = method.step_solver.parameters;
  if (solver == "augmented_lagrangian") {  // its settings with a unit of length
    own["al_tolerance_m"] = 1e-6 * L;
    own["al_penalty_initial_N_per_m"] = 10.0;
  }
  if (solver == "al_free") own["al_free_recovery_m_per_s"] = 0.01 * L;
  fit_terms(method);
  Simulation simulation(scene, method, dt, 8);
  Ran out;
  StepObserver nobody;
  for (int i = 0; i < 8; ++i) {
    const StepReport step = simulation.step(nobody);
    EXPECT_EQ(step.status, StepStatus::converged) << solver << " " << i << " " << step.detail;
    out.iterations += step.newton_iterations;
    out.contacts += step.contacts.total();
  }
  out.x = simulation.history().x;
  return out;
}

TEST(LengthScale, every_step_solver_takes_the_same_steps_in_a_scene_of_another_size) {
  const double L = 0x1p-10;
  int solvers = 0;
  for (const StepSolverEntry& entry : step_solvers()) {
    if (entry.name == "article_literal")
      continue;  // has a published stiffness of 1e-8 N/m, and a protocol of its own
    SCOPED_TRACE(entry.name);
    ++solvers;
    const Ran one = run(entry.name, 1), small = run(entry.name, L);
    EXPECT_EQ(one.iterations, small.iterations);
    EXPECT_EQ((one.x * L - small.x).cwiseAbs().maxCoeff(), 0);
    EXPECT_GT(one.contacts, 0);
    EXPECT_GT((one.x - net(1).x0).cwiseAbs().maxCoeff(), 0.01);
  }
  EXPECT_GE(solvers, 9);
}

/// Faster than its box in a step: 1 m would shorten the large scene's directions alone.
TEST(LengthScale, accumulated_toi_shortens_no_way_that_inertia_and_weight_make) {
  const Ran one = run("accumulated_toi", 1, 500), small = run("accumulated_toi", 0x1p-10, 500);
  EXPECT_EQ((one.x * 0x1p-10 - small.x).cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ(one.iterations, small.iterations);
}

}  // namespace
}  // namespace bb::length_scale_test
