// Stitches that break: in the step in which their tension passes their strength and never before, for good, and
// through archives.
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/archive/archive.hpp"
#include "tests/energy/host_family.hpp"
#include "tests/newton/converged_steps.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::breaking_test {
namespace {

constexpr double dt = 0.01, stiffness = 8, speed = 0.25;  // s, N/m, m/s
constexpr double increment = stiffness * speed * dt / 2;  // N, of the tension of both in a step
constexpr double weak = 10.5 * increment, strong = 20 * increment;
constexpr int broken_in = 10;  // step in which the tension becomes 11 increments

/// A light particle between one that is held and one that is led away, at rest at the start. strength: of the stitch to
/// the first, N.
Scene chain(double strength = weak) {
  Scene scene;
  scene.name = "chain";
  scene.bodies = {{"chain", 0, 3}};
  scene.rest.setZero(3, 3);
  scene.rest.row(0) = Eigen::RowVector3d(0, 1, 2);
  scene.x0 = scene.rest;
  scene.v0 = Positions::Zero(3, 3);
  scene.mass = {0, 1e-9, 0};
  scene.body = {0, 0, 0};
  scene.d_hat = {0.01, 0.01, 0.01};
  scene.offset = {0, 0, 0};
  scene.surface_vertices = {0, 1, 2};
  scene.motions.resize(2);
  scene.motions[1].velocity = Vec3d(speed, 0, 0);
  scene.pins = {{0, 0}, {2, 1}};
  scene.stitches = {{{0, 1}, {1, 2}}, {stiffness, stiffness}, {1, 1}, {strength, strong}};
  return scene;
}

Method method_of() {
  Method method = test::fixed_method("log", 1);
  method.step_solver.tol_velocity = 1e-9;
  return method;
}

TEST(Breaking, happens_in_the_step_in_which_the_tension_passes_the_strength) {
  const Scene scene = chain();
  Method method = method_of();
  Simulation run(scene, method, dt, 40);
  StepObserver nobody;
  for (int i = 0; i < 40; ++i) {
    const StepReport report = run.step(nobody);
    ASSERT_EQ(report.status, StepStatus::converged) << i << " " << report.detail;
    EXPECT_EQ(report.broken_stitches, i < broken_in ? 0 : 1) << i;
    const double led = 2 + speed * dt * (i + 1);
    const double expected = i <= broken_in ? led / 2 : led - 1;  // what breaks in a step holds to its end
    EXPECT_NEAR(run.history().x(0, 1), expected, 1e-6) << i;
  }
}

TEST(Breaking, does_not_happen_where_the_strength_is_larger) {
  const Scene scene = chain(3 * strong);
  Method method = method_of();
  std::vector<long long> broken;
  test::converged_steps(scene, method, dt, 19,
                        [&](const StepReport& report) { broken.push_back(report.broken_stitches); });
  EXPECT_EQ(broken, std::vector<long long>(19, 0)) << "19 increments, of 20";
}

TEST(Breaking, goes_through_archives_bit_for_bit) {
  const Scene scene = chain();
  Method method = method_of();
  StepObserver nobody;
  for (const int cut : {5, broken_in + 1, 15}) {  // before it breaks, when it has, later
    Simulation straight(scene, method, dt, 30), first(scene, method, dt, 30), second(scene, method, dt, 30);
    for (int i = 0; i < 18; ++i) straight.step(nobody);
    for (int i = 0; i < cut; ++i) first.step(nobody);
    Archive written;
    first.keep(written);
    Archive read(written.bytes());
    second.keep(read);
    long long broken = 0;
    for (int i = cut; i < 18; ++i) broken = second.step(nobody).broken_stitches;
    EXPECT_EQ(broken, 1);
    EXPECT_EQ(second.history().x, straight.history().x) << cut;
  }
}

TEST(Breaking, lets_go_with_the_acceleration_of_what_is_left) {
  Scene scene = chain(1e-6);  // the first stitch alone, which the weight breaks in the first step
  scene.mass[1] = 1;
  scene.gravity = Vec3d(10, 0, 0);
  scene.pins.pop_back();
  scene.mass[2] = 1;
  for (auto* column : {&scene.stitches.stiffness, &scene.stitches.rest_length, &scene.stitches.strength})
    column->pop_back();
  scene.stitches.pairs.pop_back();
  scene.stitches.stiffness[0] = 1000;
  Method method = test::fixed_method("log", 1, "newmark");
  method.step_solver.tol_velocity = 1e-11;
  Simulation run(scene, method, dt, 20);
  StepObserver nobody;
  ASSERT_EQ(run.step(nobody).broken_stitches, 1);
  const double x = run.history().x(0, 1), v = run.history().v(0, 1);
  ASSERT_LT(v, 0.98 * 10 * dt) << "it held";
  for (int i = 1; i < 20; ++i) {
    ASSERT_EQ(run.step(nobody).status, StepStatus::converged);
    EXPECT_NEAR(run.history().x(0, 1), x + v * i * dt + 5 * i * i * dt * dt, 1e-9) << i;
  }
}

TEST(Breaking, is_seen_by_the_next_step_alone) {
  const Scene scene = chain();
  test::HostFamily family([&](const FamilyPlace& place) { return stitch_family(place, scene.stitches); });
  ASSERT_TRUE(family->flows());
  Positions x = scene.x0;
  x(0, 1) += (weak + 1e-12) / stiffness;
  x(0, 2) += 10 * weak / stiffness;  // the other one beyond its strength, too
  EXPECT_EQ(family->broken(scene.x0.data()), 0U);
  EXPECT_EQ(family->broken(x.data()), 2U);
  const std::vector<double> before = family.values(x);
  family->end_step(x.data(), dt);
  EXPECT_EQ(family.values(x), before) << "who looks at the step that is over sees its own energy";
  family->begin_step({});
  EXPECT_GT(before[0], 0);
  EXPECT_EQ(family.values(x), (std::vector<double>{0, 0}));
  EXPECT_EQ(family->broken(scene.x0.data()), 2U) << "for good";
  for (const double compliance : family->constraints()->compliance()) EXPECT_TRUE(std::isinf(compliance));
}

TEST(Breaking, does_not_come_of_a_stitch_that_is_pushed_together) {
  const Scene scene = chain();
  test::HostFamily family([&](const FamilyPlace& place) { return stitch_family(place, scene.stitches); });
  Positions x = scene.x0;
  x(0, 1) = 0.01;
  x(0, 2) = 0.02;
  EXPECT_EQ(family->broken(x.data()), 0U);
}

}  // namespace
}  // namespace bb::breaking_test
