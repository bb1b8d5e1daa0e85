// Steps whose rest shapes follow: what a strip keeps after it was held bent, bits below the yield, and that what a step
// leaves goes through archives and retries.
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/archive/archive.hpp"
#include "core/energy/hinge.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::creep_test {
namespace {

constexpr double dt = 0.01, held_angle = 1.2, yield = 0.3, rate = 4;

/// Two triangles that are flat at rest and start bent; the edge and the first vertex are held. Without gravity.
/// plasticity: in the place of creep, in 50 ms.
Scene bent_strip(double density, double creep, double bending_yield = yield, double plasticity = 0) {
  BodySpec spec;
  spec.name = "strip";
  spec.mesh.vertices.resize(3, 4);
  spec.mesh.vertices << 0, 1, 0.3, 0.6, 0, 0, 0.8, -0.5, 0, 0, 0, 0;
  spec.mesh.triangles = {{0, 1, 2}, {1, 0, 3}};
  spec.start = spec.mesh.vertices;
  spec.start->col(3) = Vec3d(0.6, -0.5 * std::cos(held_angle), -0.5 * std::sin(held_angle));
  spec.material.density = density;
  spec.material.youngs = 1e4;
  spec.material.bending = 0.7;
  spec.material.bending_yield = creep > 0 ? bending_yield : 0;
  spec.material.bending_creep = plasticity > 0 ? 0 : creep;
  if (plasticity > 0) spec.material.plasticity = plasticity, spec.material.plasticity_step = 0.05;
  spec.d_hat = 1e-3;
  PinSpec pin;
  pin.indices = {0, 1, 2};
  spec.pins = {pin};
  SceneBuilder builder("strip", false, Vec3d::Zero(), "test");
  builder.add_body(spec);
  return builder.finish();
}

double angle_of(const Positions& x) {
  const Vec3d points[4] = {x.col(0), x.col(1), x.col(2), x.col(3)};
  return hinge_angle<double>(points);
}

void advance(Simulation& simulation, int n) {
  StepObserver nobody;
  for (int i = 0; i < n; ++i) {
    const StepReport report = simulation.step(nobody);
    ASSERT_EQ(report.status, StepStatus::converged) << i << ": " << report.detail;
  }
}

std::string bytes_of(Simulation& simulation) {
  Archive archive;
  simulation.keep(archive);
  return archive.bytes();
}

/// So heavy that its inertia holds it, for 20 steps; then light, from the same state, until it rests. What it is left is left to it.
double angle_at_rest_after_holding(double creep, double plasticity = 0) {
  const Scene heavy = bent_strip(1e9, creep, yield, plasticity),
              light = bent_strip(1, creep > 0 ? 1e-9 : 0, yield, plasticity > 0 ? 1e-12 : 0);
  Method method = test::fixed_method("log", 1);
  Simulation held(heavy, method, dt, 20);
  advance(held, 20);
  EXPECT_NEAR(angle_of(held.history().x), held_angle, 1e-8);
  Archive archive(bytes_of(held));
  Simulation free(light, method, 0.1, 300);
  free.keep(archive);
  advance(free, 300);
  return angle_of(free.history().x);
}

TEST(Creep, LeavesAStripTheAngleOfItsClosedForm) {
  const double kept = (held_angle - yield) * (1 - std::exp(-rate * 20 * dt));
  ASSERT_GT(kept, 0.4);
  EXPECT_NEAR(angle_at_rest_after_holding(rate), kept, 1e-5);
  EXPECT_NEAR(angle_at_rest_after_holding(0), 0, 1e-5);
}

/// In steps of 10 ms, its own being 50 ms: a share of 0.3 is left four times over.
TEST(Creep, OfPlasticityLeavesItsShareInItsOwnTime) {
  const double kept = (held_angle - yield) * (1 - std::pow(1 - 0.3, 20 * dt / 0.05));
  ASSERT_GT(kept, 0.6);
  EXPECT_NEAR(angle_at_rest_after_holding(1, 0.3), kept, 1e-5);
  EXPECT_NEAR(angle_at_rest_after_holding(1, 1), held_angle - yield, 1e-5);  // all at once
}

TEST(Creep, ChangesNoBitBelowTheYield) {
  const Scene plain = bent_strip(1, 0), creeping = bent_strip(1, 1e6, held_angle + 0.1);
  Method method = test::fixed_method("log", 1);
  Simulation without(plain, method, dt, 20), with(creeping, method, dt, 20);
  advance(without, 20);
  advance(with, 20);
  EXPECT_EQ(without.history().x, with.history().x);
  EXPECT_GT((without.history().x - plain.x0).norm(), 0.1);
  const Scene yielding = bent_strip(1, 1e6);
  Simulation beyond(yielding, method, dt, 20);
  advance(beyond, 20);
  EXPECT_NE(without.history().x, beyond.history().x);
}

TEST(Creep, GoesOnFromAnArchiveBitForBit) {
  const Scene scene = bent_strip(1, 20, 0.05);
  Method method = test::fixed_method("log", 1);
  Simulation whole(scene, method, dt, 12), first(scene, method, dt, 12), second(scene, method, dt, 12);
  advance(whole, 12);
  advance(first, 5);
  Archive archive(bytes_of(first));
  second.keep(archive);
  advance(second, 7);
  EXPECT_EQ(whole.history().x, second.history().x);
  const Scene plain = bent_strip(1, 0);  // the memory matters
  Simulation other(plain, method, dt, 12);
  advance(other, 12);
  EXPECT_NE(whole.history().x, other.history().x);
}

/// The first attempt of a step is cut off by its iterations; the second, of half the length, begins with the same rest angles.
TEST(Creep, IsThatOfTheStepsThatCount) {
  const Scene scene = bent_strip(1, 20, 0.05);
  Method method = test::fixed_method("log", 1);
  Simulation plain(scene, method, 0.05, 8);
  StepObserver nobody;
  const int needed = plain.step(nobody).newton_iterations;
  Method short_of = test::fixed_method("log", 1);
  short_of.step_solver.max_iterations = needed - 1;
  short_of.step_solver.retries = 3;
  Simulation retried(scene, short_of, 0.05, 8);
  const StepReport report = retried.step(nobody);
  ASSERT_EQ(report.status, StepStatus::converged) << report.detail;
  ASSERT_LT(report.dt_s, 0.05) << "nothing was tried again";
  Simulation halves(scene, method, report.dt_s, 16);
  advance(halves, 1);
  EXPECT_NEAR((halves.history().x - retried.history().x).norm(), 0, 1e-12);
  halves.step(nobody);
  ASSERT_EQ(retried.step(nobody).dt_s, report.dt_s);
  EXPECT_NEAR((halves.history().x - retried.history().x).norm(), 0, 1e-12);
  EXPECT_GT((halves.history().x - scene.x0).norm(), 1e-3);
}

}  // namespace
}  // namespace bb::creep_test
