// Coarse surfaces whose vertices pass beside an obstacle: they come to rest on it, and no part of them is ever inside.
#include <gtest/gtest.h>

#include "tests/contact/obstacle_scenes.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::test::whole_surface_test {
namespace {

constexpr double width_m = 0.02;  // d_hat

/// Runs until everything has come to rest; the gap of the whole surface is judged at the end of every step.
void expect_rest(const Scene& scene, double kappa, int n_steps) {
  double weight = 0;
  for (const double m : scene.mass) weight += m * scene.gravity.norm();
  Method method = fixed_method("log", kappa);
  Simulation simulation(scene, method, 0.01, n_steps);
  StepObserver observer;
  StepReport report;
  Positions before = scene.x0;
  double speed = 0;
  for (int k = 0; k < n_steps; ++k) {
    before = simulation.history().x;
    report = simulation.step(observer);
    ASSERT_EQ(report.status, StepStatus::converged) << report.detail;
    ASSERT_GT(least_gap(scene, simulation.history().x), 0) << "step " << k;
    speed = (simulation.history().x - before).cwiseAbs().maxCoeff() / 0.01;
  }
  EXPECT_LT(speed, 1e-2);
  EXPECT_GT(report.contacts.obstacle, 0U);
  EXPECT_NEAR(report.gap_min_m.value, least_gap(scene, simulation.history().x), 1e-9);
  EXPECT_LT(report.gap_min_m.value, width_m);
  EXPECT_NEAR(report.contact_load_sum_N.value / weight, 1, 0.15);  // normals are nearly upright
}

TEST(WholeSurface, TwoTrianglesComeToRestOnBallsBetweenTheirCorners) {
  SceneBuilder builder("balls", false, Vec3d(0, 0, -10), "test");
  BodySpec sheet = cloth_spec(2, 0.12, width_m);  // two triangles, 1 m wide
  sheet.offset = 0.004;
  sheet.material.bending = 0.1;
  const Vec3d middle = sheet.mesh.vertices.rowwise().mean();
  builder.add_body(sheet);
  int n = 0;
  for (const double x : {-0.2, 0.2}) {
    for (const double y : {-0.25, 0.25}) {
      Obstacle ball = round_obstacle(ObstacleKind::sphere, Vec3d(middle[0] + x, middle[1] + y, 0), 0.1);
      ball.name = "ball" + std::to_string(n++);
      builder.add_obstacle(ball);
    }
  }
  expect_rest(builder.finish(), 200, 120);
}

TEST(WholeSurface, ARodOfOneSegmentComesToRestOnTwoBars) {
  SceneBuilder builder("bars", false, Vec3d(0, 0, -10), "test");
  BodySpec rod;
  rod.name = "rod";
  rod.mesh.vertices.resize(3, 2);
  rod.mesh.vertices << -0.5, 0.5, 0, 0.05, 0.115, 0.115;
  rod.mesh.segments = {{0, 1}};
  rod.material.line_density = 0.05;
  rod.material.springs = 2000;
  rod.d_hat = width_m;
  builder.add_body(rod);
  for (const double x : {-0.2, 0.25}) {
    Obstacle bar = round_obstacle(ObstacleKind::cylinder, Vec3d(x, 0, 0), 0.1, Vec3d(0.1, 1, 0).normalized());
    bar.name = x < 0 ? "left" : "right";
    builder.add_obstacle(bar);
  }
  expect_rest(builder.finish(), 200, 120);
}

}  // namespace
}  // namespace bb::test::whole_surface_test
