// Friction of bodies each by itself, in closed form: among bodies without friction every other one is slowed by its own load; what
// sticks to an obstacle that turns goes round with it, however often a step renews its contacts.
#include <gtest/gtest.h>

#include <numbers>

#include "barriers/matching.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::friction_of_each_test {
namespace {

constexpr double d_hat = 0.01, kappa = 2e4, g = 10;

double resting_gap(const Method& method, double load) {
  return equilibrium(method.contact, kappa, d_hat, load).d.value();
}

struct Slider {
  double mass;
  std::optional<double> friction;
};

/// Particles beside each other on the floor, each in equilibrium with its weight, that slide along x at 1 m/s.
Scene sliding(const std::vector<Slider>& sliders, const Method& method) {
  Scene scene = test::particle_over_plane(1, 1, d_hat);
  const auto n = static_cast<Eigen::Index>(sliders.size());
  scene.bodies.clear(), scene.mass.clear(), scene.body.clear(), scene.surface_vertices.clear();
  scene.x0.setZero(3, n), scene.v0.setZero(3, n);
  scene.v0.row(0).setOnes();
  for (int v = 0; v < n; ++v) {
    const Slider& of = sliders[static_cast<std::size_t>(v)];
    scene.bodies.push_back({"slider" + std::to_string(v), v, 1, of.friction});
    scene.mass.push_back(of.mass);
    scene.body.push_back(v);
    scene.surface_vertices.push_back(v);
    scene.x0.col(v) = Vec3d(0, v, resting_gap(method, of.mass * g));
  }
  scene.rest = scene.x0;
  scene.d_hat.assign(sliders.size(), d_hat);
  scene.offset.assign(sliders.size(), 0);
  return scene;
}

Method rubbing(double mu, int renewals) {
  Method method = test::fixed_method("cubic", kappa);
  method.friction.mu = mu;
  method.friction.lag_iterations = renewals;
  method.step_solver.tol_velocity = 1e-9;
  return method;
}

StepReport converged_step(Simulation& simulation) {
  StepObserver nobody;
  StepReport report = simulation.step(nobody);
  EXPECT_EQ(report.status, StepStatus::converged) << report.detail;
  return report;
}

TEST(FrictionOfEach, IsThatOfItsOwnLoadWhereOthersHaveNone) {
  constexpr double dt = 0.005;
  std::vector<Slider> sliders = {{0.2, 0.3}, {1.0, 0.0}, {3.0, 0.5}, {0.5, 0.0}, {0.05, std::nullopt}};
  for (std::size_t turn = 0; turn < sliders.size(); ++turn) {
    std::rotate(sliders.begin(), sliders.begin() + 1, sliders.end());
    for (const int renewals : {1, 3}) {
      Method method = rubbing(0.4, renewals);  // of the floor, and of the one that says nothing
      const Scene scene = sliding(sliders, method);
      Simulation simulation(scene, method, dt, 8);
      for (int step = 1; step <= 8; ++step) {
        ASSERT_EQ(converged_step(simulation).contacts.obstacle, sliders.size());
        for (std::size_t v = 0; v < sliders.size(); ++v) {
          const double mu = std::min(0.4, sliders[v].friction.value_or(0.4));
          EXPECT_NEAR(simulation.history().v(0, static_cast<int>(v)), 1 - mu * g * step * dt, 1e-6)
              << "slider " << v << " of order " << turn << ", step " << step;
        }
      }
    }
  }
}

/// A triangle that lies on a table which turns about the z axis, at its speed from the start.
Scene on_a_table(double omega, const Method& method) {
  SceneBuilder builder("table", false, Vec3d(0, 0, -g), "test");
  BodySpec body;
  body.name = "triangle";
  body.mesh.vertices.resize(3, 3);
  body.mesh.vertices << 0.4, 0.6, 0.5, 0.1, 0.15, 0.3, 0, 0, 0;
  body.mesh.triangles = {{0, 1, 2}};
  body.material.density = 40;
  body.material.youngs = 1e5;
  body.d_hat = d_hat;
  const double area = 0.5 * std::abs(0.2 * 0.2 - 0.1 * 0.05);
  body.mesh.vertices.row(2).setConstant(resting_gap(method, body.material.density * area * g / 3));
  builder.add_body(body);
  Obstacle table;
  table.name = "table";
  table.motion.angular_velocity = omega;
  table.motion.axis = Vec3d::UnitZ();
  builder.add_obstacle(table);
  Scene scene = builder.finish();
  for (int v = 0; v < 3; ++v) scene.v0.col(v) = omega * Vec3d::UnitZ().cross(Vec3d(scene.x0.col(v)));
  return scene;
}

TEST(FrictionOfEach, TakesWhatSticksAroundWithATableThatTurns) {
  constexpr double dt = 0.02, omega = 2;
  for (const int renewals : {1, 2, 4}) {
    Method method = rubbing(0.9, renewals);
    method.friction.eps_v = 1e-5;
    const Scene scene = on_a_table(omega, method);
    Simulation simulation(scene, method, dt, 20);
    for (int step = 1; step <= 20; ++step) {
      const StepReport report = converged_step(simulation);
      ASSERT_EQ(report.contacts.obstacle, 3U);
      ASSERT_EQ(report.friction_sticking, 3) << step;
    }
    const Mat3d turned = Eigen::AngleAxisd(omega * 20 * dt, Vec3d::UnitZ()).toRotationMatrix();
    for (int v = 0; v < 3; ++v) {
      const Vec3d expected = turned * scene.x0.col(v);
      EXPECT_LT((simulation.history().x.col(v) - expected).head<2>().norm(), 2e-4)
          << "vertex " << v << " with " << renewals << " solves a step";
    }
  }
}

}  // namespace
}  // namespace bb::friction_of_each_test
