// Steps of projection: the stiffness that the sweeps make, whatever N/m a spring has; contact; what is left; what it refuses.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/math/error.hpp"
#include "core/step_solvers/registry.hpp"
#include "tests/newton/converged_steps.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::projection_test {
namespace {

constexpr double dt = 0.01, d_hat = 0.005, edge = 0.1;  // s, m, m

/// n vertices along a direction from a height (m), the first one held where `held`; over the plane z = 0 where `floor`.
Scene chain(int n, double height, const Vec3d& along, bool held, bool floor, double stiffness = 200,
            double speed = 0) {
  BodySpec body;
  body.name = "chain";
  body.mesh.vertices.setZero(3, n);
  for (int i = 0; i < n; ++i) body.mesh.vertices.col(i) = Vec3d(0, 0, height) + edge * i * along;
  for (int i = 0; i + 1 < n; ++i) body.mesh.segments.push_back({i, i + 1});
  body.material.line_density = 0.02;
  body.material.springs = stiffness;
  body.material.model = "none";
  body.velocity = Vec3d(0, 0, -speed);
  body.d_hat = d_hat;
  if (held) {
    PinSpec pin;
    pin.indices = {0};
    body.pins = {pin};
  }
  SceneBuilder builder("chain", false, Vec3d(0, 0, -10), "test");
  builder.add_body(body);
  Obstacle plane;
  plane.name = "floor";
  if (floor) builder.add_obstacle(plane);
  return builder.finish();
}

struct Ran {
  Positions x;
  StepReport last;
  double of(const std::string& counter) const { return last.solver.values.at(counter); }
};

Ran run(const Scene& scene, double stiffness, int sweeps, int steps) {
  Method method = test::fixed_method("cubic", 100);
  choose_step_solver(method, "projection");
  method.step_solver.max_iterations = sweeps;
  method.step_solver.saddle = SaddleRule::ignore;
  method.step_solver.parameters["projection_stiffness"] = stiffness;
  method.contact.literal = true;
  Ran out;
  out.x = test::converged_steps(scene, method, dt, steps,
                                [&out](const StepReport& report) { out.last = report; });
  return out;
}

const Vec3d down = -Vec3d::UnitZ(), level = Vec3d::UnitX();

/// One spring, one step: gravity would stretch it by g dt^2, of which the part 1 - k is left however many sweeps there are.
TEST(Projection, of_a_lone_spring_the_sweeps_leave_the_part_that_its_stiffness_says) {
  const Scene scene = chain(2, 1, down, true, false);
  const double free = 10 * dt * dt;
  for (const double k : {0.25, 0.9, 1.0}) {
    for (const int sweeps : {1, 7, 100}) {
      const Ran ran = run(scene, k, sweeps, 1);
      EXPECT_NEAR(ran.x(2, 0) - ran.x(2, 1) - edge, (1 - k) * free, 1e-14) << k << " " << sweeps;
      EXPECT_NEAR(ran.of("projection_stretch_m"), (1 - k) * free, 1e-14) << k << " " << sweeps;
      EXPECT_EQ(ran.of("projection_sweeps"), sweeps);
    }
  }
}

TEST(Projection, is_as_stiff_as_its_sweeps_and_not_as_its_springs) {
  const Scene soft = chain(6, 1, down, true, false, 20), stiff = chain(6, 1, down, true, false, 2e5);
  const Ran few = run(soft, 1, 2, 10), many = run(soft, 1, 500, 10);
  EXPECT_EQ(few.x, run(stiff, 1, 2, 10).x);
  EXPECT_GT(few.of("projection_stretch_m"), 1e-4);
  EXPECT_LT(many.of("projection_stretch_m"), 1e-12);
  EXPECT_EQ(many.of("projection_constraints"), 5);
  EXPECT_EQ(many.x.col(0), soft.x0.col(0));  // held
}

TEST(Projection, contact_keeps_a_chain_that_falls_above_the_floor_and_pulls_nothing_down) {
  const Scene falls = chain(6, 0.05, level, false, true, 200, 20);
  const Ran ran = run(falls, 1, 100, 20);
  EXPECT_GT(ran.last.contacts.total(), 0U);
  EXPECT_GE(ran.x.row(2).minCoeff(), 0);
  EXPECT_LT(ran.x.row(2).maxCoeff(), 1e-12);
  EXPECT_LT(ran.of("projection_overlap_m"), 1e-15);
  // within d_hat of the floor and on its way up
  const auto rises = [](bool floor) { return chain(6, 0.8 * d_hat, level, false, floor, 200, -0.15); };
  const Ran near = run(rises(true), 1, 10, 1);
  EXPECT_EQ(near.of("projection_constraints"), 5 + 6);
  ASSERT_LT(near.x.row(2).maxCoeff(), d_hat);
  EXPECT_EQ(near.of("projection_overlap_m"), 0) << "an open gap is no overlap";
  EXPECT_EQ(near.x, run(rises(false), 1, 10, 1).x);
}

TEST(Projection, refuses_by_name_what_is_no_constraint) {
  SceneBuilder builder("cloth", false, Vec3d(0, 0, -10), "test");
  builder.add_body(test::cloth_spec(3, 1, d_hat));
  const Scene cloth = builder.finish();
  Method method = test::fixed_method("cubic", 100);
  choose_step_solver(method, "projection");
  try {
    Simulation(cloth, method, dt, 1);
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("projection with the term membrane"), std::string::npos)
        << error.what();
  }
}

/// Every entry states what its steps keep.
TEST(StepSolvers, SayWhatTheyGuarantee) {
  for (const StepSolverEntry& entry : step_solvers()) EXPECT_FALSE(entry.guarantee.empty()) << entry.name;
}

}  // namespace
}  // namespace bb::projection_test
