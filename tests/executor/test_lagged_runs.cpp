// Friction, restitution, obstacles that move and what drives free vertices: whole steps of the resident pipeline end where the CPU path
// ends.
#include <gtest/gtest.h>

#include "core/base/archive/archive.hpp"
#include "core/energy/friction_law.hpp"
#include "core/model/mesh/solid_generators.hpp"
#include "tests/executor/both_systems.hpp"
#include "tests/executor/system_cases.hpp"

namespace bb::exec_lagged_runs_test {
namespace {

using test::expect_same_run;
using test::RunEnd;

constexpr double tolerance = 1e-6;  // m, after some steps of 1e-8 m each

Method rubbing(const std::string& law = "smoothed_coulomb", double mu = 0.3) {
  Method out = test::fixed_method("cubic", 20);
  out.friction.law = law;
  out.friction.mu = mu;
  out.friction.eps_v = 0.02;
  return out;
}

/// A cloth that touches plate and floor and is drawn over them.
Scene drawn_cloth() {
  Scene scene = test::touching(test::cloth_on_plate(), 0.012);
  scene.v0.row(0).array() += 0.3;
  for (const Pin& pin : scene.pins) scene.v0.col(pin.vertex).setZero();
  return scene;
}

TEST(ExecutorFriction, OfEveryLaw) {
  for (const std::string& law : friction_law_names()) {
    SCOPED_TRACE(law);
    const RunEnd end = expect_same_run(
        drawn_cloth(), [&] { return rubbing(law); }, 6, tolerance);
    EXPECT_GT(end.sliding, 20);
    EXPECT_GT(end.friction_work, 1e-5);
  }
}

TEST(ExecutorFriction, OfCoefficientsOfTheSides) {
  for (const CombineRule rule : {CombineRule::min, CombineRule::max, CombineRule::mean}) {
    SCOPED_TRACE(static_cast<int>(rule));
    Scene scene = drawn_cloth();
    scene.bodies[0].friction = 0.5, scene.bodies[1].friction = 0.1;
    scene.obstacles[0].friction = 0.8;
    const auto method = [&] {
      Method out = rubbing("smoothed_coulomb", 0);
      out.friction.combine = rule;
      return out;
    };
    EXPECT_GT(expect_same_run(scene, method, 4, tolerance).sliding, 10);
  }
}

// Between two sheets, some of whose edges are close to parallel; with a policy whose kappa is anew in every iteration.
TEST(ExecutorFriction, OfAllKindsOfRows) {
  Scene scene = test::touching(test::two_sheets(), 0.008);
  for (int v = 16; v < scene.n_vertices(); ++v) scene.v0(0, v) = 0.2;
  const auto method = [&] {
    Method out = test::method_with_policy(
        "cubic", "elasticity_inclusive",
        {{"mass_term", std::string("inertia")}, {"refresh", std::string("per_step")}});
    out.friction = rubbing().friction;
    out.hessian_mode = HessianMode::projected_full;
    return out;
  };
  EXPECT_GT(expect_same_run(scene, method, 4, tolerance).sliding, 10);
}

TEST(ExecutorFriction, SolvedAgainWithTheLoadsOfTheEnd) {
  RunEnd ends[3];
  for (const int times : {1, 2, 3}) {
    SCOPED_TRACE(times);
    const auto method = [&] {
      Method out = rubbing();
      out.friction.lag_iterations = times;
      return out;
    };
    ends[times - 1] = expect_same_run(drawn_cloth(), method, 5, tolerance);
    EXPECT_GT(ends[times - 1].sliding, 10);
  }
  EXPECT_GT((ends[1].x - ends[0].x).cwiseAbs().maxCoeff(), 10 * tolerance);
}

/// One iterate of both paths, some contacts sliding.
TEST(ExecutorFriction, HasTheNumbersOfTheIterate) {
  test::Both both(test::touching(test::cloth_on_plate(), 0.012), [] {
    Method out = rubbing();
    out.hessian_mode = HessianMode::projected_full;
    return out;
  });
  for (StepSystem* system : both.systems()) {
    ASSERT_EQ(system->find_direction().linear.status, LinearStatus::ok);
    system->prepare_motion(MotionEnd::on_target, true);
    IterationReport report;
    const double alpha = 0.9 * system->bound_motion(report);
    const auto change = system->try_motion(alpha);
    ASSERT_TRUE(change.has_value());
    system->accept();
    system->assemble();
  }
  const double expected = both.cpu.view().energy(TermGroup::friction);
  ASSERT_GT(expected, 1e-9);
  EXPECT_NEAR(both.resident.view().energy(TermGroup::friction), expected, 1e-9 * expected);
  const auto of_free = [&](Positions g) {  // rows have no force at given vertices on an executor
    for (int v = 0; v < both.scene.n_vertices(); ++v) {
      if (both.scene.mass[static_cast<std::size_t>(v)] == 0) g.col(v).setZero();
    }
    return g;
  };
  const Positions g = of_free(both.cpu.view().gradient());
  EXPECT_LT((of_free(both.resident.view().gradient()) - g).cwiseAbs().maxCoeff(),
            1e-8 * g.cwiseAbs().maxCoeff());
  // what is read of a copy on the host is that of the step, not of the iterate
  NewtonSystem& copy = both.resident.on_host();
  EXPECT_NEAR(copy.view().energy(TermGroup::friction), expected, 1e-9 * expected);
  EXPECT_LT((of_free(copy.view().gradient()) - g).cwiseAbs().maxCoeff(), 1e-8 * g.cwiseAbs().maxCoeff());
}

/// Balls of solid that fall on a floor.
Scene bouncing() {
  SceneBuilder builder("bouncing", false, Vec3d(0, 0, -10), "test");
  for (const double e : {0.5, 1.0}) {
    BodySpec block;
    block.name = e < 1 ? "soft" : "hard";
    block.mesh = solid_box_mesh({1, 1, 1}, Vec3d(0.1, 0.1, 0.1));
    block.mesh.vertices.row(0).array() += 0.5 * e;
    block.mesh.vertices.row(2).array() += 0.075 + 0.01 * e;
    block.material.solid_youngs = 2e3;
    block.material.solid_density = 20;
    block.d_hat = 0.02;
    block.velocity = Vec3d(0.1, 0, -0.6);
    block.restitution = e;
    builder.add_body(block);
  }
  Obstacle floor;
  floor.name = "floor";
  builder.add_obstacle(floor);
  return builder.finish();
}

TEST(ExecutorRestitution, TakesWhatTheHostTakes) {
  const auto method = [] { return test::fixed_method("cubic", 200, "newmark"); };
  const RunEnd end = expect_same_run(bouncing(), method, 12, tolerance);
  EXPECT_GT(end.bounce_work, 1e-4);
}

TEST(ExecutorRestitution, AndFrictionTogether) {
  const auto method = [] {
    Method out = rubbing();
    out.friction.lag_iterations = 2;
    return out;
  };
  const RunEnd end = expect_same_run(bouncing(), method, 8, tolerance);
  EXPECT_GT(end.bounce_work, 1e-5);
  EXPECT_GT(end.sliding + end.sticking, 5);
}

// A run that goes on from an archive of either path knows how fast its pairs met.
TEST(ExecutorRestitution, IsKept) {
  const Scene scene = bouncing();
  for (const bool from_executor : {false, true}) {
    Method whole = test::fixed_method("cubic", 200), again = test::fixed_method("cubic", 200);
    test::use_executor_solver(whole), test::use_executor_solver(again);
    test::run_on_executor(from_executor ? whole : again);
    Simulation simulation(scene, whole, 0.01, 12), resumed(scene, again, 0.01, 12);
    const RunEnd before = test::run_steps(simulation, 6);
    ASSERT_GT(before.bounce_work, 1e-6);
    Archive archive;
    simulation.keep(archive);
    Archive read(archive.bytes());
    resumed.keep(read);
    EXPECT_TRUE(read.at_end());
    const RunEnd straight = test::run_steps(simulation, 3), other = test::run_steps(resumed, 3);
    EXPECT_GT(straight.bounce_work, 1e-6);
    test::expect_same_end(from_executor ? straight : other, from_executor ? other : straight, tolerance);
  }
}

/// A cloth on a ball that pushes, a bar that turns and a floor that rises.
Scene cloth_on_moving(bool turns) {
  Scene plain = test::cloth_on_balls_and_bar();
  SceneBuilder builder("moving", false, Vec3d(0, 0, -10), "test");
  BodySpec cloth = test::cloth_spec(4, 0.128, 0.03);
  cloth.material.bending = 1e-3;
  cloth.offset = 0.002;
  builder.add_body(cloth);
  for (Obstacle o : plain.obstacles) {
    if (o.name == "left") o.motion.velocity = Vec3d(0.1, 0, 0.05);
    if (o.name == "near") o.motion.velocity = Vec3d(0, 0.1, 0.1);
    if (o.name == "bar") {
      o.motion.velocity = Vec3d(-0.1, 0, 0.1);
      o.motion.axis = Vec3d::UnitY();
      o.motion.center = o.point;
      o.motion.angular_velocity = turns ? 2 : 0;
    }
    builder.add_obstacle(o);
  }
  return builder.finish();
}

TEST(ExecutorObstacles, MoveAsOnTheHost) {
  for (const HessianMode mode : {HessianMode::gauss_newton, HessianMode::projected_full}) {
    const auto method = [&] {
      Method out = test::fixed_method("cubic", 40);
      out.hessian_mode = mode;
      return out;
    };
    const RunEnd end = expect_same_run(cloth_on_moving(false), method, 8, tolerance);
    EXPECT_GT(end.contacts, 40u);
  }
}

TEST(ExecutorObstacles, TakeTheirSurfaceAlongByFriction) {
  const auto method = [] { return rubbing("smoothed_coulomb", 0.4); };
  const RunEnd turned = expect_same_run(cloth_on_moving(true), method, 6, tolerance),
               still = test::run_steps(cloth_on_moving(false), rubbing("smoothed_coulomb", 0.4), 6);
  EXPECT_GT(turned.sliding + turned.sticking, 10);
  EXPECT_GT((turned.x - still.x).cwiseAbs().maxCoeff(), 100 * tolerance) << "the turn is seen";
}

/// A cloth and a closed block, pulled, blown at, stitched together, under pressure, on springs of cloth.
Scene driven() {
  SceneBuilder builder("driven", false, Vec3d(0, 0, -10), "test");
  builder.set_air({0.4, 0.1, Vec3d(0.5, 0, 0), {{0, Vec3d(0.5, 0, 0)}, {1, Vec3d(-4, 3, 0)}}});
  builder.set_gravity({{0, Vec3d(0, 0, -10)}, {0.05, Vec3d(0, 1, -8)}});
  BodySpec cloth = test::cloth_spec(5, 0.015, 0.02);
  cloth.material.cloth_tension = 20, cloth.material.cloth_tension_growing = 5,
  cloth.material.cloth_compression = 2;
  cloth.material.cloth_creep = 2, cloth.material.cloth_yield = 1e-4;
  cloth.material.bending = 1e-3, cloth.material.bending_exponential = 1e-3;
  cloth.material.bending_creep = 3, cloth.material.membrane_creep = 3, cloth.material.membrane_yield = 1e-4;
  cloth.material.shrink_keys = {{0, 1}, {1, 0.5}};
  PinSpec& pull = cloth.pins.emplace_back();
  pull.indices = {0, 4};
  pull.pull = 2;
  pull.motion.velocity = Vec3d(0, 0, 0.5);
  builder.add_body(cloth);
  BodySpec block;
  block.name = "block";
  block.mesh = solid_box_mesh({1, 1, 1}, Vec3d(0.2, 0.2, 0.2));
  block.mesh.vertices.colwise() += Vec3d(1, 0, 0.3);
  block.material.solid_youngs = 500;
  block.material.solid_density = 10;
  block.pressure = 20;
  block.d_hat = 0.02;
  builder.add_body(block);
  builder.add_stitch({"cloth", "block", {24}, {0}, 3, 0.1}, "/stitches/0");
  Obstacle floor;
  floor.name = "floor";
  builder.add_obstacle(floor);
  return builder.finish();
}

TEST(ExecutorDriven, EndsWhereTheHostEnds) {
  const Scene scene = driven();
  const Plan plan = make_plan(scene, test::fixed_method("cubic", 20), {});
  for (const char* term : {"pull", "air_drag", "inflation", "stitch", "cloth_springs", "hinges"}) {
    ASSERT_TRUE(plan.term(term).needed) << term;
  }
  expect_same_run(
      scene, [] { return test::fixed_method("cubic", 20); }, 8, tolerance);
}

// Where the set of pins changes another system, on an executor of its own, goes on.
TEST(ExecutorDriven, PinsThatAreReleased) {
  SceneBuilder builder("released", false, Vec3d(0, 0, -10), "test");
  BodySpec cloth = test::cloth_spec(4, 0.02, 0.02);
  cloth.material.bending = 1e-3, cloth.material.bending_creep = 5;
  cloth.restitution = 0.5;
  PinSpec& pin = cloth.pins.emplace_back();
  pin.indices = {0, 3, 12};
  pin.motion.velocity = Vec3d(0, 0, 0.1);
  pin.span = {-1, 0.045};
  builder.add_body(cloth);
  Obstacle floor;
  floor.name = "floor";
  builder.add_obstacle(floor);
  const Scene scene = builder.finish();
  const RunEnd end = expect_same_run(
      scene, [] { return rubbing(); }, 8, tolerance);
  EXPECT_LT(end.x(2, 0), 0.02 + 0.1 * 0.08 - 1e-4) << "it fell";
}

}  // namespace
}  // namespace bb::exec_lagged_runs_test
