// In float no step has a tolerance below the rounding of its coordinates: of which coordinates, and only in float.
#include <gtest/gtest.h>

#include "tests/newton/scripted_system.hpp"

namespace bb::float_tolerance_test {
namespace {

using test::ScriptedState;
using test::ScriptedStep;

constexpr double asked = ScriptedStep::tolerance;
constexpr double epsilon = std::numeric_limits<float>::epsilon();

/// Whether the tolerance of a step is `tolerance`: without a known rate the error of a direction counts as 9 times
/// its length, so a direction of a ninth of the tolerance is on the edge.
void expect_tolerance(const ScriptedState& state, double tolerance) {
  const auto ends = [&state](double dx) {
    const ScriptedStep step({{.dx = dx, .slope = -1e-6}}, SaddleRule::ignore, 0.1, 1, state);
    return step.report.status == StepStatus::converged;
  };
  EXPECT_TRUE(ends(tolerance / 9.01)) << "coarser than " << tolerance;
  EXPECT_FALSE(ends(tolerance / 8.99)) << "finer than " << tolerance;
}

ScriptedState in_float(const Positions& x, const std::vector<std::uint8_t>& fixed = {0, 0, 0}) {
  return {Precision::single, x, fixed};
}

TEST(FloatTolerance, IsEightRoundingsOfTheLargestCoordinate) {
  const double large = 1e6;
  ASSERT_GT(8 * epsilon * large, 100 * asked);
  expect_tolerance(in_float(test::one_point(large, 0, 1)), 8 * epsilon * large);
  expect_tolerance(in_float(test::one_point(3, -large, 1)), 8 * epsilon * large);
  expect_tolerance(in_float(test::one_point(3, 0, 2 * large)), 16 * epsilon * large);
}

TEST(FloatTolerance, IsWhatIsAskedForWhereThatIsMore) {
  const double edge = asked / (8 * epsilon);  // where the two are one
  expect_tolerance(in_float(test::one_point(0.5 * edge, 0, 0)), asked);
  expect_tolerance(in_float(test::one_point(0, 0, 0)), asked);
  expect_tolerance(in_float(test::one_point(2 * edge, 0, 0)), 2 * asked);
}

TEST(FloatTolerance, OfOtherPrecisionsIsWhatIsAskedForWhereverTheBodiesAre) {
  for (const Precision precision : {Precision::full, Precision::mixed}) {
    ScriptedState state;
    state.precision = precision;
    state.x = test::one_point(1e6, -1e7, 1);
    expect_tolerance(state, asked);
  }
}

/// What does not move has no rounding that a step could not get below, however far away it is.
TEST(FloatTolerance, DoesNotSeeCoordinatesThatArePrescribed) {
  const double far = 1e9, near = 1e6;
  Positions two(3, 2);
  two << far, near, 0, -2, far, 1;
  expect_tolerance(in_float(two, {1, 1, 1, 0, 0, 0}), 8 * epsilon * near);
  // one by one: a coordinate that is locked beside two that are free
  expect_tolerance(in_float(test::one_point(near, 1, far), {0, 0, 1}), 8 * epsilon * near);
  expect_tolerance(in_float(test::one_point(near, 1, far), {1, 0, 0}), 8 * epsilon * far);
  expect_tolerance(in_float(test::one_point(far, far, far), {1, 1, 1}), asked);
}

/// A particle on a floor, alone and in a scene with a prescribed body at 1e6 m: the same steps, bit for bit.
TEST(FloatTolerance, OfAParticleIsTheSameBesideAPrescribedBodyFarAway) {
  struct End {
    double z;
    int iterations;
    std::size_t contacts;
  };
  const auto run = [](bool with_far_body) {
    Scene scene = test::particle_over_plane(0.2, 0.008, 0.01);
    if (with_far_body) {
      scene.bodies.push_back({"far", 1, 1});
      scene.x0.conservativeResize(3, 2);
      scene.x0.col(1) = Vec3d(1e6, 0, 1);
      scene.rest = scene.x0;
      scene.v0 = Positions::Zero(3, 2);
      scene.mass.push_back(0), scene.body.push_back(1), scene.d_hat.push_back(0.01),
          scene.offset.push_back(0);
      scene.motions.resize(1);
      scene.pins = {{1, 0}};
    }
    Method method = test::fixed_method("log", 30);
    method.precision = Precision::single;
    method.contact.in_float = true;
    Simulation simulation(scene, method, 0.01, 1);
    StepObserver nobody;
    const StepReport report = simulation.step(nobody);
    EXPECT_EQ(report.status, StepStatus::converged);
    return End{simulation.history().x(2, 0), report.newton_iterations, report.contacts.obstacle};
  };
  const End alone = run(false), beside = run(true);
  ASSERT_EQ(alone.contacts, 1U);
  ASSERT_GT(alone.iterations, 2);
  EXPECT_EQ(beside.iterations, alone.iterations);
  EXPECT_EQ(beside.z, alone.z);
}

}  // namespace
}  // namespace bb::float_tolerance_test
