// Steps of xpbd: with many sweeps the implicit Euler step of the Newton path, contact as an inequality without compliance,
// and what it refuses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/math/error.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::xpbd_test {
namespace {

constexpr double dt = 0.01, d_hat = 0.005;
constexpr int n_vertices = 6;

/// A chain of springs along x at a height (m), held at its first vertex where `held`; beside a plane z = 0 where `floor`.
Scene chain(double height, bool held, bool floor, double speed = 0) {
  BodySpec body;
  body.name = "chain";
  body.mesh.vertices.setZero(3, n_vertices);
  for (int i = 0; i < n_vertices; ++i) body.mesh.vertices.col(i) = Vec3d(0.1 * i, 0, height);
  for (int i = 0; i + 1 < n_vertices; ++i) body.mesh.segments.push_back({i, i + 1});
  body.material.line_density = 0.02;
  body.material.springs = 200;
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

Method method_of(const std::string& solver, int sweeps = 200) {
  Method method = test::fixed_method("cubic", 100);
  method.step_solver.name = solver;
  method.step_solver.max_iterations = sweeps;
  method.step_solver.saddle = SaddleRule::ignore;
  method.step_solver.tol_velocity = 1e-12;
  method.contact.literal = solver == "xpbd";
  return method;
}

struct Ran {
  Positions x;
  StepReport last;
};

Ran run(const Scene& scene, const std::string& solver, int sweeps, int steps) {
  Method method = method_of(solver, sweeps);
  Simulation simulation(scene, method, dt, steps);
  StepObserver none;
  Ran out;
  for (int i = 0; i < steps; ++i) {
    out.last = simulation.step(none);
    EXPECT_EQ(out.last.status, StepStatus::converged) << solver << " " << i << " " << out.last.detail;
  }
  out.x = simulation.history().x;
  return out;
}

TEST(Xpbd, a_hanging_chain_converges_to_the_implicit_euler_step) {
  const Scene scene = chain(1, true, false);
  const int steps = 10;
  const Positions newton = run(scene, "line_search", 200, steps).x;
  ASSERT_GT((newton - scene.x0).norm(), 0.05);
  double before = 1;
  for (const int sweeps : {10, 100, 1000}) {
    const Ran ran = run(scene, "xpbd", sweeps, steps);
    const double off = (ran.x - newton).cwiseAbs().maxCoeff();
    EXPECT_LT(off, 0.2 * before) << sweeps;
    EXPECT_GT(off + ran.last.solver.values.at("xpbd_correction_m"), 0);
    before = off;
    EXPECT_EQ(run(scene, "xpbd", sweeps, steps).x, ran.x);
    EXPECT_EQ(ran.x.col(0), scene.x0.col(0));  // held
    EXPECT_EQ(ran.last.solver.values.at("xpbd_sweeps"), sweeps);
    EXPECT_EQ(ran.last.solver.values.at("xpbd_constraints"), n_vertices - 1);
  }
  EXPECT_LT(before, 1e-11);
}

TEST(Xpbd, a_chain_that_falls_faster_than_it_can_see_stays_above_the_floor) {
  const double height = 0.05;
  for (const bool floor : {true, false}) {
    const Scene scene = chain(height, false, floor, 20);
    const Ran ran = run(scene, "xpbd", 300, 20);
    const double lowest = ran.x.row(2).minCoeff(), highest = ran.x.row(2).maxCoeff();
    if (!floor) {
      EXPECT_LT(highest, -1);
      continue;
    }
    EXPECT_GT(ran.last.contacts.total(), 0U);
    EXPECT_GT(lowest, -1e-15);
    EXPECT_LT(highest, 1e-12);  // compliance 0: it lies on the plane itself
    EXPECT_EQ(ran.last.solver.values.at("xpbd_constraints"), 2 * n_vertices - 1);
  }
}

/// What the floor pushed in the first sweeps, and the springs then pull away, is given back.
TEST(Xpbd, a_contact_that_does_not_last_leaves_nothing) {
  const auto scene = [](bool floor) {
    Scene out = chain(0.02, true, floor, 0);
    for (Eigen::Index i = 1; i < out.x0.cols(); ++i) out.v0(2, i) = -2.05;  // to 0.5 mm below the floor
    for (double& k : out.springs.stiffness) k = 2e4;
    return out;
  };
  const Ran with = run(scene(true), "xpbd", 4000, 1), without = run(scene(false), "xpbd", 4000, 1);
  ASSERT_GT(without.x.row(2).minCoeff(), 0);  // the springs hold it
  EXPECT_LT((with.x - without.x).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(Xpbd, makes_no_linear_solver_and_compares_no_energies) {
  const Scene scene = chain(1, true, false);
  Method method = method_of("xpbd");
  const Plan plan = make_plan(scene, method, plan_options(method));
  for (const PlanItem* item : {&plan.linear_solver, &plan.preconditioner, &plan.policy_submatrix,
                               &plan.trial_energies, &plan.end_check, &plan.step_bound}) {
    EXPECT_FALSE(item->needed) << item->reason;
  }
  EXPECT_EQ(plan.linear_solver.reason, "the step solver has no matrix");
  const Ran ran = run(scene, "xpbd", 10, 1);
  EXPECT_EQ(ran.last.newton_iterations, 0);
  EXPECT_EQ(ran.last.linear_solves, 0);
  EXPECT_FALSE(ran.last.end_error_m.finite());
}

template <class Make>
std::string refusal(const Make& make) {
  try {
    make();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Xpbd, refuses_by_name_what_is_no_constraint) {
  SceneBuilder builder("cloth", false, Vec3d(0, 0, -10), "test");
  builder.add_body(test::cloth_spec(3, 1, d_hat));
  const Scene cloth = builder.finish(), over = chain(1, false, true);
  Method method = method_of("xpbd");
  EXPECT_NE(refusal([&] { Simulation(cloth, method, dt, 1); }).find("xpbd with the term membrane"),
            std::string::npos);
  EXPECT_EQ(refusal([&] { Simulation(over, method, dt, 1); }), "accepted");
  PolicyConfig dynamic;
  dynamic.name = "elasticity_inclusive";
  method.stiffness = make_policy(dynamic);
  EXPECT_NE(refusal([&] { Simulation(over, method, dt, 1); }).find("/formulation/stiffness_policy/name"),
            std::string::npos);
}

}  // namespace
}  // namespace bb::xpbd_test
