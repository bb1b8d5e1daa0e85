// Vertices that are prescribed for a time: exact while they are, free with all of their mass before and after.
#include <gtest/gtest.h>

#include <numeric>

#include "core/base/archive/archive.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::released_pins_test {
namespace {

constexpr double dt = 0.02, g = 9.81;

/// A cloth of 4 x 4 vertices at a height, three corners of which are driven upwards within a span; a floor at 0.
Scene held_cloth(const HoldSpan& span, double height, double speed) {
  SceneBuilder builder("held cloth", false, Vec3d(0, 0, -g), "test");
  BodySpec spec = test::cloth_spec(4, height, 0.01);
  PinSpec& pin = spec.pins.emplace_back();
  pin.indices = {0, 3, 12};
  pin.motion.velocity = Vec3d(0, 0, speed);
  pin.span = span;
  builder.add_body(spec);
  Obstacle floor;
  floor.name = "floor";
  builder.add_obstacle(floor);
  return builder.finish();
}

Vec3d momentum(const Scene& scene, const Positions& v) {
  Vec3d out = Vec3d::Zero();
  for (Eigen::Index i = 0; i < v.cols(); ++i) out += scene.mass[static_cast<std::size_t>(i)] * v.col(i);
  return out;
}

double weight(const Scene& scene) { return g * std::accumulate(scene.mass.begin(), scene.mass.end(), 0.0); }

Method exact_method(const std::string& integrator = "implicit_euler") {
  Method method = test::fixed_method("log", 50, integrator);
  method.step_solver.tol_velocity = 1e-9;
  return method;
}

TEST(ReleasedPins, AreExactUntilThenAndFallWithTheRestAfterwards) {
  const Scene scene = held_cloth({-1, 2.5 * dt}, 3, 0.4);
  EXPECT_NEAR(weight(scene), 0.3 * g, 1e-12) << "all of the mass is there";
  Method method = exact_method();
  Simulation simulation(scene, method, dt, 6);
  StepObserver observer;
  for (int step = 1; step <= 6; ++step) {
    const Vec3d before = momentum(scene, simulation.history().v);
    const Positions v = simulation.history().v;
    const StepReport report = simulation.step(observer);
    ASSERT_EQ(report.status, StepStatus::converged) << report.detail;
    const bool holds = step <= 2;  // the middle of the third is the time of release
    for (const Pin& pin : scene.pins) {
      const Vec3d x = simulation.history().x.col(pin.vertex), pose = pin_pose(scene, pin, simulation.time());
      EXPECT_EQ(x == pose, holds) << step;
    }
    const Vec3d change = momentum(scene, simulation.history().v) - before;
    if (holds) continue;
    EXPECT_NEAR(change[2], -weight(scene) * dt, 1e-7) << step << ": nothing holds it";
    EXPECT_NEAR(change.head<2>().norm(), 0, 1e-7);
  }
  EXPECT_LT(simulation.history().v(2, 0), 0.4);
}

TEST(ReleasedPins, KeepTheSpeedThatTheyHave) {
  Scene scene = held_cloth({-1, 2.5 * dt}, 3, 0.4);
  scene.gravity.setZero();
  scene.v0.row(2).setConstant(0.4);  // all moves alike
  Method method = exact_method();
  Simulation simulation(scene, method, dt, 6);
  StepObserver observer;
  for (int step = 1; step <= 6; ++step) ASSERT_EQ(simulation.step(observer).status, StepStatus::converged);
  EXPECT_LT((simulation.history().v.row(2).array() - 0.4).abs().maxCoeff(), 1e-9);
}

/// The way of held vertices begins within a step, with a kink: whatever the integrator and however many steps later they are let go,
/// they go on as fast as they went.
TEST(ReleasedPins, GoOnAsFastAsTheyWereTakenAlong) {
  for (const std::string integrator : {"implicit_euler", "newmark", "bdf2"}) {
    for (const double release : {5.5, 6.5}) {
      Scene scene = held_cloth({-1, release * dt}, 3, 0.4);
      scene.gravity.setZero();
      scene.motions.at(0).start = 1.25 * dt;
      scene.pins.clear();
      for (int v = 0; v < 16; ++v) scene.pins.push_back({v, 0, {-1, release * dt}});
      scene.v0.setZero();
      Method method = exact_method(integrator);
      Simulation simulation(scene, method, dt, 10);
      StepObserver observer;
      for (int step = 1; step <= 10; ++step)
        ASSERT_EQ(simulation.step(observer).status, StepStatus::converged);
      EXPECT_LT((simulation.history().v.row(2).array() - 0.4).abs().maxCoeff(), 1e-9)
          << integrator << " " << release;
    }
  }
}

TEST(ReleasedPins, FallFromTheirFirstStepOn) {
  for (const std::string integrator : {"implicit_euler", "newmark", "bdf2"}) {
    Scene scene = held_cloth({-1, 2.5 * dt}, 3, 0);
    scene.pins.clear();
    for (int v = 0; v < 16; ++v) scene.pins.push_back({v, 0, {-1, 2.5 * dt}});
    Method method = exact_method(integrator);
    Simulation simulation(scene, method, dt, 8);
    StepObserver observer;
    for (int step = 1; step <= 8; ++step) ASSERT_EQ(simulation.step(observer).status, StepStatus::converged);
    EXPECT_LT((simulation.history().v.row(2).array() + 6 * dt * g).abs().maxCoeff(), 1e-6) << integrator;
  }
}

/// Thrown, then held where they started for a time: what is let go is at rest.
TEST(ReleasedPins, LoseTheSpeedThatTheyWereThrownWith) {
  for (const std::string integrator : {"implicit_euler", "newmark", "bdf2"}) {
    Scene scene = held_cloth({1.5 * dt, 4.5 * dt}, 3, 0);
    scene.gravity.setZero();
    scene.pins.clear();
    for (int v = 0; v < 16; ++v) scene.pins.push_back({v, 0, {1.5 * dt, 4.5 * dt}});
    scene.v0.row(2).setConstant(1);
    Method method = exact_method(integrator);
    Simulation simulation(scene, method, dt, 7);
    StepObserver observer;
    ASSERT_EQ(simulation.step(observer).status, StepStatus::converged);
    EXPECT_NEAR(simulation.history().v(2, 0), 1, 1e-9) << "thrown";
    for (int step = 2; step <= 7; ++step) ASSERT_EQ(simulation.step(observer).status, StepStatus::converged);
    EXPECT_LT(simulation.history().v.cwiseAbs().maxCoeff(), 1e-8) << integrator;
  }
}

TEST(ReleasedPins, MayBeHeldLater) {
  const Scene scene = held_cloth({1.5 * dt, std::numeric_limits<double>::infinity()}, 3, 0);
  Method method = exact_method();
  Simulation simulation(scene, method, dt, 5);
  StepObserver observer;
  ASSERT_EQ(simulation.step(observer).status, StepStatus::converged);
  EXPECT_NEAR(simulation.history().v(2, 0), -g * dt, 1e-7) << "free";
  for (int step = 2; step <= 4; ++step) {
    ASSERT_EQ(simulation.step(observer).status, StepStatus::converged);
    EXPECT_EQ(simulation.history().x(2, 0) == 3, step >= 3) << step;
  }
  EXPECT_LT(simulation.history().x(2, 5), 3 - 0.001);
}

TEST(ReleasedPins, AreStoppedByContactOnceTheyAreFree) {
  const Scene scene = held_cloth({-1, 2.5 * dt}, 0.03, 0);
  Method method = test::fixed_method("log", 2e3);
  method.step_solver.tol_velocity = 1e-5;
  Simulation simulation(scene, method, dt, 30);
  StepObserver observer;
  std::size_t touching = 0;
  for (int step = 1; step <= 30; ++step) {
    const StepReport report = simulation.step(observer);
    ASSERT_EQ(report.status, StepStatus::converged) << step << " " << report.detail;
    touching = report.contacts.total();
  }
  EXPECT_EQ(touching, 16u) << "every vertex rests on the floor, those that were held too";
  EXPECT_GT(simulation.history().x.row(2).minCoeff(), 0);
  EXPECT_LT(simulation.history().x.row(2).maxCoeff(), 0.01);
}

TEST(ReleasedPins, GoOnFromAnArchiveOfEitherSide) {
  const Scene scene = held_cloth({-1, 2.5 * dt}, 0.011, 0);
  for (const std::string integrator : {"implicit_euler", "newmark", "bdf2"}) {
    for (const int stop : {1, 2, 3, 4}) {
      Method method = exact_method(integrator), again = exact_method(integrator);
      method.step_solver.tol_velocity = again.step_solver.tol_velocity = 1e-6;
      Simulation whole(scene, method, dt, 6), second(scene, again, dt, 6);
      StepObserver observer;
      Archive kept;
      for (int step = 1; step <= 6; ++step) {
        ASSERT_EQ(whole.step(observer).status, StepStatus::converged);
        if (step == stop) whole.keep(kept);
      }
      Archive read(kept.bytes());
      second.keep(read);
      EXPECT_EQ(second.nominal_steps(), stop);
      for (int step = stop + 1; step <= 6; ++step) second.step(observer);
      EXPECT_EQ(whole.history().x, second.history().x) << integrator << " " << stop;
      EXPECT_EQ(whole.history().v, second.history().v) << integrator << " " << stop;
    }
  }
}

}  // namespace
}  // namespace bb::released_pins_test
