// Prescribed vertices: exact poses, motion lifted to the right-hand side, a pose that cannot be reached.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/contact/contact_scenes.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::pins_test {
namespace {

PinSpec corners(std::vector<int> indices, const Vec3d& velocity) {
  PinSpec pin;
  pin.indices = std::move(indices);
  pin.motion.velocity = velocity;
  return pin;
}

TEST(Pins, driven_vertices_are_exactly_at_their_pose_and_a_rigid_motion_strains_nothing) {
  SceneBuilder builder("driven cloth", false, Vec3d::Zero(), "test");
  BodySpec spec = test::cloth_spec(4, 0, 0.001);
  spec.velocity = Vec3d(0.5, 0, 0);
  spec.pins = {corners({0, 3, 12, 15}, Vec3d(0.5, 0, 0))};
  builder.add_body(spec);
  Scene scene = builder.finish();
  Method method = test::fixed_method("log", 1);
  Simulation simulation(scene, method, 0.02, 5);
  StepObserver observer;
  for (int i = 0; i < 5; ++i) ASSERT_EQ(simulation.step(observer).status, StepStatus::converged);
  for (const Pin& pin : scene.pins) {
    EXPECT_EQ(simulation.history().x.col(pin.vertex), pin_pose(scene, pin, simulation.time()));
  }
  EXPECT_NEAR(simulation.history().x(0, 5) - scene.x0(0, 5), 0.05, 1e-12);
}

TEST(Pins, lifting_carries_the_interior_in_the_first_newton_step) {
  SceneBuilder builder("driven cloth", false, Vec3d::Zero(), "test");
  BodySpec spec = test::cloth_spec(4, 0, 0.001);
  spec.material.youngs = 1e6;
  spec.pins = {corners({0, 3, 12, 15}, Vec3d(0, 0.5, 0))};
  builder.add_body(spec);
  Scene scene = builder.finish();
  Method method = test::fixed_method("log", 1);
  method.step_solver.max_iterations = 1;
  Simulation simulation(scene, method, 0.02, 1);
  StepObserver observer;
  simulation.step(observer);
  EXPECT_NEAR(simulation.history().x(1, 5) - scene.x0(1, 5), 0.01, 1e-3);  // 0 without lifting
}

TEST(Pins, a_plate_that_moves_several_d_hat_a_step_pushes_a_free_cloth_ahead_of_it) {
  SceneBuilder builder("plate under cloth", false, Vec3d::Zero(), "test");
  builder.add_body(test::cloth_spec(4, 0.02, 0.01));
  BodySpec plate = test::cloth_spec(2, 0, 0.01);
  plate.name = "plate";
  plate.kind = BodyKind::rigid;
  plate.mesh.vertices.row(0) *= 1.3;
  plate.mesh.vertices.row(1) *= 1.3;
  plate.motion.velocity = Vec3d(0, 0, 3);
  builder.add_body(plate);
  Scene scene = builder.finish();
  Method method = test::fixed_method("cubic", 2e4);
  Simulation simulation(scene, method, 0.01, 5);
  StepObserver observer;
  std::size_t contacts = 0;
  for (int i = 0; i < 5; ++i) {
    const StepReport report = simulation.step(observer);
    ASSERT_EQ(report.status, StepStatus::converged) << report.detail;
    contacts += report.contacts.total();
  }
  EXPECT_GT(contacts, 0U);
  EXPECT_NEAR(simulation.history().x(2, 17), 0.15, 1e-15);             // the plate is where it has to be
  EXPECT_GT(simulation.history().x.row(2).head(16).minCoeff(), 0.15);  // and the cloth is above it
}

/// A rod of one edge along x, turned by `angle` (rad) about z, far from the other at rest.
BodySpec rod(const std::string& name, double angle, double height) {
  BodySpec spec;
  spec.name = name;
  spec.mesh.vertices.resize(3, 2);
  const Vec3d half = 0.5 * Vec3d(std::cos(angle), std::sin(angle), 0);
  spec.mesh.vertices << -half, half;
  spec.mesh.segments = {{0, 1}};
  spec.start = spec.mesh.vertices;
  spec.start->row(2).array() += height;
  spec.mesh.vertices.row(2).array() += 100 * height;
  spec.material.line_density = 0.1;
  spec.material.springs = 10;
  spec.d_hat = 0.02;
  return spec;
}

// A nearly parallel pair carries the mollifier. The right-hand side has to know that its given edge moves:
// the model's gradient after the motion of the pins alone is the gradient there, to first order.
TEST(Pins, the_motion_of_a_given_edge_is_lifted_through_a_mollified_row) {
  SceneBuilder builder("two rods", false, Vec3d::Zero(), "test");
  BodySpec given = rod("given", 0, -0.004);
  given.kind = BodyKind::rigid;
  given.motion.velocity = Vec3d(0, 0, 1);
  builder.add_body(given);
  builder.add_body(rod("free", 0.02, 0.004));
  Scene scene = builder.finish();
  scene.surface_vertices.clear();  // the pair of edges alone
  Method method = test::fixed_method("cubic", 500);
  NewtonSystem system(scene, method);
  Prediction prediction;
  const Positions none = Positions::Zero(3, 4);
  method.integrator->predict({0, 0, scene.x0, scene.v0, none, scene.x0, scene.v0}, 0.01, prediction);
  system.begin_step(scene.x0, prediction, 0.01, 1);
  system.assemble();
  ASSERT_EQ(test::reported(system).contacts.mollified, 1U);
  ASSERT_EQ(test::reported(system).contacts.total(), 1U);
  const Positions gradient = system.view().gradient();

  const double motion = 1e-6;  // m
  Positions target = scene.x0, dx;
  for (const Pin& pin : scene.pins) target(2, pin.vertex) += motion;
  ASSERT_EQ(test::solve(system, target, dx).linear.status, LinearStatus::ok);
  Positions free_motion = dx;
  for (const Pin& pin : scene.pins) free_motion.col(pin.vertex).setZero();
  VecXd moved, wanted;
  system.diagnosis().blocks().restrict_vector(free_motion, moved);
  const VecXd model = system.diagnosis().solved().lower.selfadjointView<Eigen::Lower>() * moved;

  ASSERT_TRUE(test::try_state(system, target).has_value());
  system.accept();
  system.assemble();
  system.diagnosis().blocks().restrict_vector(Positions(-system.view().gradient()), wanted);
  ASSERT_GT((system.view().gradient() - gradient).cwiseAbs().maxCoeff(), 1e-6);  // N: the motion is felt
  EXPECT_LT((model - wanted).lpNorm<Eigen::Infinity>(),
            1e-3 * (system.view().gradient() - gradient).cwiseAbs().maxCoeff());
}

/// A plate that rises by three times its distance to a free particle, both too far apart for a contact at the
/// start: the first direction moves nothing that is free, and a bound keeps the plate short of its pose.
TEST(Pins, a_step_converges_at_its_pose_only) {
  Scene scene;
  const auto [vertices, triangles] = test::grid(2, 2, 1.0);
  test::add_body(scene, "plate", vertices, triangles, 0.001, true);
  test::add_body(scene, "particle", {Vec3d(0.7, 0.4, 0.01)}, {}, 0.001);
  scene.motions[0].velocity = Vec3d(0, 0, 3);
  Method method = test::fixed_method("log", 50);
  Simulation simulation(scene, method, 0.01, 1);
  StepObserver observer;
  ASSERT_EQ(simulation.step(observer).status, StepStatus::converged);
  EXPECT_EQ(simulation.history().x(2, 0), 0.03);
  EXPECT_GT(simulation.history().x(2, 9), 0.03);
}

/// A plate that rises under a particle over one of its corners. The bound of each vertex lets the other corners go all the way,
/// and that one not: all of them go as far as that one.
TEST(Pins, that_contact_holds_back_go_all_the_same_part_of_their_way) {
  const double rise = 0.03, gap = 0.01;
  for (const StepBoundRule rule :
       {StepBoundRule::planar_truncation, StepBoundRule::planar_balanced, StepBoundRule::per_vertex}) {
    Scene scene;
    const auto [vertices, triangles] = test::grid(2, 2, 1.0);
    test::add_body(scene, "plate", vertices, triangles, 0.001, true);
    test::add_body(scene, "particle", {Vec3d(0.1, 0.1, gap)}, {}, 0.001);
    Method method = test::fixed_method("log", 50);
    method.contact_options.step_bound = rule;
    NewtonSystem system(scene, method);
    Prediction at_rest;
    at_rest.x_tilde = scene.x0;
    system.begin_step(scene.x0, at_rest, 0.01, 1);
    system.assemble();
    Positions target = scene.x0, dx;
    for (const Pin& pin : scene.pins) target(2, pin.vertex) += rise;
    ASSERT_EQ(test::solve(system, target, dx).linear.status, LinearStatus::ok);
    system.prepare_motion(MotionEnd::on_target, true);
    IterationReport report;
    ASSERT_LT(system.bound_motion(report), 1);
    const auto motion = system.truncate_motion(report);
    ASSERT_TRUE(motion.has_value());
    EXPECT_EQ(motion->bound, 1);
    EXPECT_GT(motion->of_pins, 0);
    ASSERT_LT(motion->of_pins * rise, gap) << "or nothing is held back";
    ASSERT_TRUE(system.try_feasible(1));
    system.accept();
    const Positions x = system.view().x();
    for (const Pin& pin : scene.pins)
      EXPECT_NEAR(x(2, pin.vertex) - scene.x0(2, pin.vertex), motion->of_pins * rise, 1e-15)
          << to_string(rule) << ", vertex " << pin.vertex;
  }
}

/// x + (pose - x) is not always the pose: a full step puts a driven vertex on it all the same.
TEST(Pins, one_full_step_reaches_a_pose_that_a_sum_would_miss) {
  Scene scene;
  test::add_body(scene, "pair", {Vec3d(0.7, 0, 0), Vec3d(0, 5, 0)}, {}, 0.001);
  scene.pins = {{0, 0}};
  scene.motions.resize(1);
  scene.mass = {0, 1};
  scene.gravity = Vec3d(0, 0, -10);
  const Vec3d start = scene.x0.col(0);
  Vec3d pose = start;
  for (int turn = 100; turn < 200 && start + (pose - start) == pose; ++turn) {
    scene.motions[0].angular_velocity = turn;
    pose = pin_pose(scene, scene.pins[0], 0.01);
  }
  ASSERT_NE(Vec3d(start + (pose - start)), pose);
  Method method = test::fixed_method("log", 1);
  Simulation simulation(scene, method, 0.01, 1);
  StepObserver observer;
  const StepReport report = simulation.step(observer);
  ASSERT_EQ(report.status, StepStatus::converged);
  EXPECT_EQ(simulation.history().x.col(0), pose);
  EXPECT_EQ(report.newton_iterations, 2);  // the step and the one that finds nothing more to do
}

TEST(Pins, a_pose_beyond_the_strain_limit_is_infeasible_and_names_the_pin) {
  SceneBuilder builder("torn cloth", false, Vec3d::Zero(), "test");
  BodySpec spec = test::cloth_spec(3, 0, 0.001);
  spec.material.limit = StrainLimitSpec{0.01, 0.01};
  spec.pins = {corners({0, 3, 6}, Vec3d::Zero()), corners({2, 5, 8}, Vec3d(5, 0, 0))};
  builder.add_body(spec);
  Scene scene = builder.finish();
  Method method = test::fixed_method("log", 1);
  method.limit_stiffness = test::fixed_limit(10);
  Simulation simulation(scene, method, 0.01, 2);
  StepObserver observer;
  StepReport report;
  for (int i = 0; i < 2 && report.status == StepStatus::converged; ++i) report = simulation.step(observer);
  EXPECT_EQ(report.status, StepStatus::pin_infeasible) << to_string(report.status) << " " << report.detail;
  EXPECT_NE(report.detail.find("pinned vertex 2 of body 'cloth'"), std::string::npos) << report.detail;
  EXPECT_LT(report.max_stretch.value, 0.02);
}

}  // namespace
}  // namespace bb::pins_test
