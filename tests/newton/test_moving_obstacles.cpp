// Obstacles that move: what they carry, push and rub, by balances and closed forms; and who cannot get where it should.
#include <gtest/gtest.h>

#include "barriers/matching.hpp"
#include "core/contact/contact_loads.hpp"
#include "tests/contact/moving_obstacles.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::moving_obstacles_test {
namespace {

constexpr double d_hat = 0.01, dt = 0.01;

Obstacle plane(const Vec3d& velocity, double height = 0) {
  Obstacle out;
  out.name = "plane";
  out.point = Vec3d(0, 0, height);
  out.motion.velocity = velocity;
  return out;
}

Obstacle ball(const Vec3d& centre, double radius, const Vec3d& velocity) {
  Obstacle out;
  out.name = "ball";
  out.kind = ObstacleKind::sphere;
  out.point = centre;
  out.radius = radius;
  out.motion.velocity = velocity;
  return out;
}

/// Steps until the end; every one converges.
struct Steps {
  Scene scene;
  Method method;
  Simulation simulation;
  StepReport last;
  std::size_t contacts = 0;

  Steps(Scene of, Method with, int steps)
      : scene(std::move(of)), method(std::move(with)), simulation(scene, method, dt, steps) {}
  void go(int steps) {
    StepObserver observer;
    for (int i = 0; i < steps; ++i) {
      last = simulation.step(observer);
      ASSERT_EQ(last.status, StepStatus::converged) << "step " << i << ": " << last.detail;
      contacts += last.contacts.total();
    }
  }
  Vec3d momentum() const {
    Vec3d sum = Vec3d::Zero();
    for (int v = 0; v < scene.n_vertices(); ++v) {
      sum += scene.mass[static_cast<std::size_t>(v)] * simulation.history().v.col(v);
    }
    return sum;
  }
};

TEST(MovingObstacles, a_plane_that_rises_carries_a_particle_at_the_gap_of_a_still_one) {
  constexpr double kappa = 2e4, mass = 0.2, speed = 0.4;
  const Scene scene =
      test::with_moving_obstacles(test::particle_over_plane(mass, 0.9 * d_hat, d_hat), Vec3d(0, 0, speed));
  Method method = test::fixed_method("cubic", kappa);
  method.step_solver.tol_velocity = 1e-10;
  Steps run(scene, std::move(method), 600);
  run.go(600);
  const auto expected = equilibrium(run.method.contact, kappa, d_hat, 10 * mass);
  ASSERT_TRUE(expected.d.has_value());
  const Positions& x = run.simulation.history().x;
  EXPECT_EQ(run.last.contacts.obstacle, 1U);
  EXPECT_NEAR(x(2, 1), 6 * speed, 1e-13) << "the plane is where it has to be";
  EXPECT_NEAR((x(2, 0) - x(2, 1)) / *expected.d, 1, 1e-7);
  EXPECT_NEAR(run.simulation.history().v(2, 0), speed, 1e-8);
}

/// A cloth, pinned at two corners, over a ball; all of it moves with `common`.
Scene draped(const Vec3d& common) {
  SceneBuilder builder("draped", false, Vec3d(0, 0, -9.81), "test");
  BodySpec cloth = test::cloth_spec(6, 0.31, d_hat);
  cloth.velocity = common;
  PinSpec& pin = cloth.pins.emplace_back();
  pin.indices = {0, 5};
  pin.motion.velocity = common;
  builder.add_body(cloth);
  builder.add_obstacle(ball(cloth.mesh.vertices.rowwise().mean() - Vec3d(0, 0, 0.31), 0.3, common));
  return builder.finish();
}

TEST(MovingObstacles, nothing_changes_where_all_of_a_scene_moves_with_one_velocity) {
  const auto method = [] {
    Method out = test::fixed_method("cubic", 2e4);
    out.step_solver.tol_velocity = 1e-9;
    out.friction.mu = 0.3;
    return out;
  };
  const Vec3d common(0.3, -0.2, 0.5);
  Steps still(draped(Vec3d::Zero()), method(), 30), moving(draped(common), method(), 30);
  still.go(30);
  moving.go(30);
  EXPECT_EQ(still.scene.obstacles[0].vertex, -1);
  ASSERT_EQ(moving.scene.obstacles[0].vertex, 36);
  EXPECT_GT(still.contacts, 30U);
  EXPECT_GT(still.last.friction_dissipation_J.value, 1e-6);
  const Positions difference =
      (moving.simulation.history().x.leftCols(36).colwise() - Vec3d(common * 30 * dt)) -
      still.simulation.history().x;
  EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-7);
  const Positions fallen = still.simulation.history().x - still.scene.x0;
  EXPECT_GT(fallen.cwiseAbs().maxCoeff(), 0.05);
}

TEST(MovingObstacles, the_momentum_of_a_cloth_that_a_plane_hits_is_what_its_contacts_give_it) {
  SceneBuilder builder("hit", false, Vec3d::Zero(), "test");
  builder.add_body(test::cloth_spec(4, 0.5 * d_hat, d_hat));
  builder.add_obstacle(plane(Vec3d(0.2, 0, 1.5)));
  Method method = test::fixed_method("log", 500);
  method.step_solver.tol_velocity = 1e-9;
  method.friction.mu = 0;
  Steps run(builder.finish(), std::move(method), 20);
  Vec3d given = Vec3d::Zero();
  struct Watch final : StepObserver {
    Vec3d force = Vec3d::Zero();
    void on_step(StepSystem& system, const StepReport&, const Positions& x) override {
      ContactLoads loads;
      const TermList& terms = system.on_host().diagnosis().terms();
      for (const auto& term : terms) term->add_loads(x, loads);
      force.setZero();
      for (std::size_t r = 0; r < loads.size(); ++r) {
        if (pair_obstacle(loads.pair[r]) >= 0) force += loads.load[r] * Vec3d::Map(&loads.normal[3 * r]);
      }
    }
  } watch;
  for (int i = 0; i < 20; ++i) {
    const StepReport report = run.simulation.step(watch);
    ASSERT_EQ(report.status, StepStatus::converged) << report.detail;
    given += dt * watch.force;
  }
  ASSERT_GT(given[2], 0.1);
  EXPECT_LT((run.momentum() - given).norm(), 1e-5 * given.norm());
  EXPECT_GT(run.momentum()[2], 1.5 * 0.3) << "thrown ahead of the plane";
}

TEST(MovingObstacles, a_plane_that_slides_takes_a_cloth_along_by_friction) {
  SceneBuilder builder("rubbed", false, Vec3d(0, 0, -9.81), "test");
  builder.add_body(test::cloth_spec(3, 0.5 * d_hat, d_hat));
  builder.add_obstacle(plane(Vec3d(2, 0, 0)));
  constexpr double mu = 0.25;
  Method method = test::fixed_method("log", 200);
  method.step_solver.tol_velocity = 1e-8;
  method.friction.mu = mu;
  Steps run(builder.finish(), std::move(method), 400);
  run.go(30);                                     // until it has settled on its gap
  const double before = run.momentum()[0] / 0.3;  // mass 0.3 kg
  run.go(25);
  const double gained = run.momentum()[0] / 0.3 - before;
  ASSERT_LT(before + gained, 1.9);
  EXPECT_NEAR(gained, mu * 9.81 * 25 * dt, 0.03 * gained) << "mu g t while it slides";
  run.go(100);
  EXPECT_NEAR(run.momentum()[0] / 0.3, 2, 1e-3) << "then it goes along";
}

/// Each turns so that its surface goes along x under the particle with 3 m/s; its point stays.
TEST(MovingObstacles, that_spin_take_along_what_lies_on_them) {
  constexpr double mass = 0.2, mu = 0.3, radius = 2, height = 0.5 * d_hat;
  for (const auto& [kind, lag_iterations] : {std::pair{ObstacleKind::plane, 1},
                                             {ObstacleKind::plane, 2},
                                             {ObstacleKind::sphere, 1},
                                             {ObstacleKind::cylinder, 1}}) {
    Scene scene = test::particle_over_plane(mass, height, d_hat);
    Obstacle& o = scene.obstacles[0];
    o.kind = kind;
    o.radius = kind == ObstacleKind::plane ? 0 : radius;
    o.point = kind == ObstacleKind::plane ? Vec3d(0, radius, 0) : Vec3d(0, 0, -radius);
    o.axis = kind == ObstacleKind::plane ? Vec3d::UnitZ() : Vec3d::UnitY();
    scene = test::with_moving_obstacles(std::move(scene), Vec3d::Zero());
    PrescribedMotion& motion = scene.motions.back();
    motion.axis = scene.obstacles[0].axis;
    motion.center = scene.obstacles[0].point;
    motion.angular_velocity = 3 / radius;
    scene.obstacles[0].motion = motion;
    Method method =
        test::fixed_method("cubic", 10 * mass / (2 / d_hat * height * height));  // rests at that gap
    method.step_solver.tol_velocity = 1e-9;
    method.friction.mu = mu;
    method.friction.lag_iterations = lag_iterations;
    Steps run(std::move(scene), std::move(method), 20);
    run.go(20);
    const Vec3d v = run.simulation.history().v.col(0);
    EXPECT_NEAR(v[0], mu * 10 * 20 * dt, 0.05 * v[0])
        << static_cast<int>(kind);  // on the round ones it slides downhill
    EXPECT_NEAR(v[1], 0, 0.1);
    EXPECT_EQ(run.last.friction_sliding, 1);
  }
}

/// The same turn of a ball under a particle by a rate, by keyframes, and in two operations of which the second turns the other
/// way: friction sees the turn of all of them.
TEST(MovingObstacles, take_along_the_same_whichever_way_their_turn_is_said) {
  constexpr double mass = 0.2, radius = 2, height = 0.5 * d_hat;
  PrescribedMotion by_rate;
  by_rate.axis = Vec3d::UnitY();
  by_rate.center = Vec3d(0, 0, -radius);
  by_rate.angular_velocity = 0.3 / radius;
  PrescribedMotion by_keyframes = by_rate;
  by_keyframes.angular_velocity = 0;
  by_keyframes.keyframes = {{0, Vec3d::Zero(), 0, 1}, {2, Vec3d::Zero(), 2 * 0.3 / radius, 1}};
  PrescribedMotion in_two = by_rate;
  in_two.angular_velocity = 0.5 / radius;
  in_two.then = {static_cast<const MotionStep&>(by_rate)};
  in_two.then[0].angular_velocity = -0.2 / radius;
  std::vector<Vec3d> velocities;
  for (const PrescribedMotion& motion : {by_rate, by_keyframes, in_two}) {
    Scene scene = test::particle_over_plane(mass, height, d_hat);
    scene.obstacles[0].kind = ObstacleKind::sphere;
    scene.obstacles[0].radius = radius;
    scene.obstacles[0].point = motion.center;
    scene = test::with_moving_obstacles(std::move(scene), Vec3d::Zero());
    scene.motions.back() = scene.obstacles[0].motion = motion;
    Method method = test::fixed_method("cubic", 10 * mass / (2 / d_hat * height * height));
    method.step_solver.tol_velocity = 1e-7;
    method.friction.mu = 0.3;
    method.friction.eps_v = 0.02;
    Steps run(std::move(scene), std::move(method), 20);
    run.go(20);
    velocities.push_back(run.simulation.history().v.col(0));
  }
  EXPECT_NEAR(velocities[0][0], 0.3, 0.02) << "it sticks to the surface";
  for (const Vec3d& v : velocities) EXPECT_LT((v - velocities[0]).norm(), 1e-5);
}

TEST(MovingObstacles, a_ball_pushes_a_pinned_cloth_out_of_its_way) {
  SceneBuilder builder("pushed", false, Vec3d::Zero(), "test");
  BodySpec cloth = test::cloth_spec(7, 0, d_hat);
  cloth.pins.emplace_back().indices = {0, 6, 42, 48};
  builder.add_body(cloth);
  Obstacle pushing = ball(cloth.mesh.vertices.rowwise().mean() - Vec3d(0, 0, 0.23), 0.2, Vec3d(0, 0, 2));
  pushing.motion.end = 0.15;
  builder.add_obstacle(pushing);
  Steps run(builder.finish(), test::fixed_method("log", 500), 25);
  run.go(25);
  const Positions& x = run.simulation.history().x;
  const Vec3d centre = x.col(49);
  EXPECT_EQ(centre[2], -0.23 + 2 * 0.15);
  EXPECT_GT(run.contacts, 50U);
  for (int v = 0; v < 49; ++v) EXPECT_GT((x.col(v) - centre).norm(), 0.2);
  EXPECT_GT(x(2, 24), centre[2] + 0.2) << "its middle is above the ball";
}

TEST(MovingObstacles, one_that_is_driven_against_a_pin_is_infeasible_and_both_are_named) {
  SceneBuilder builder("squeezed", false, Vec3d::Zero(), "test");
  BodySpec cloth = test::cloth_spec(3, 0, 0.005);
  cloth.offset = 0.02;
  cloth.pins.emplace_back().indices = {0};
  builder.add_body(cloth);
  const Vec3d corner = cloth.mesh.vertices.col(0);
  builder.add_obstacle(
      ball(corner - Vec3d(0, 0, 0.25), 0.2, Vec3d(0, 0, 4)));  // ends inside the corner's thickness
  Steps run(builder.finish(), test::fixed_method("log", 500), 1);
  StepObserver observer;
  const StepReport report = run.simulation.step(observer);
  EXPECT_EQ(report.status, StepStatus::pin_infeasible) << to_string(report.status) << " " << report.detail;
  for (const char* word : {"'ball' cannot reach its pose", "held by obstacle", "cloth[0]"}) {
    EXPECT_NE(report.detail.find(word), std::string::npos) << report.detail;
  }
}

}  // namespace
}  // namespace bb::moving_obstacles_test
