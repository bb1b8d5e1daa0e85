// Steps of xpbd: with many sweeps the implicit Euler step of the Newton path as far as gradients stay, contact as an inequality
// without compliance, and what it refuses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/math/error.hpp"
#include "core/step_solvers/registry.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::xpbd_test {
namespace {

constexpr double dt = 0.01, d_hat = 0.005;
constexpr int n_vertices = 6;

/// A chain of springs from its first vertex at a height (m) along a direction, held there where `held`; over a plane z = 0
/// where `floor`.
Scene chain(double height, const Vec3d& along, bool held, bool floor, double speed = 0,
            double stiffness = 200) {
  BodySpec body;
  body.name = "chain";
  body.mesh.vertices.setZero(3, n_vertices);
  for (int i = 0; i < n_vertices; ++i) body.mesh.vertices.col(i) = Vec3d(0, 0, height) + 0.1 * i * along;
  for (int i = 0; i + 1 < n_vertices; ++i) body.mesh.segments.push_back({i, i + 1});
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

Method method_of(const std::string& solver, int sweeps = 200) {
  Method method = test::fixed_method("cubic", 100);
  choose_step_solver(method, solver);
  method.step_solver.max_iterations = sweeps;
  method.step_solver.saddle = SaddleRule::ignore;
  method.step_solver.tol_velocity = 1e-10;
  method.contact.literal = solver == "xpbd";
  return method;
}

struct Ran {
  Positions x;
  StepReport last;
};

Ran run(const Scene& scene, const std::string& solver, int sweeps, int steps, double step = dt) {
  Method method = method_of(solver, sweeps);
  Simulation simulation(scene, method, step, steps);
  StepObserver none;
  Ran out;
  for (int i = 0; i < steps; ++i) {
    out.last = simulation.step(none);
    EXPECT_EQ(out.last.status, StepStatus::converged) << solver << " " << i << " " << out.last.detail;
  }
  out.x = simulation.history().x;
  return out;
}

const Vec3d down = -Vec3d::UnitZ(), level = Vec3d::UnitX();

/// Its gradients do not turn.
TEST(Xpbd, a_chain_that_hangs_straight_converges_to_the_implicit_euler_step) {
  const Scene scene = chain(1, down, true, false);
  const int steps = 10;
  const Positions newton = run(scene, "line_search", 200, steps).x;
  ASSERT_GT((newton - scene.x0).norm(), 1e-3);
  for (const int sweeps : {10, 200}) {
    const Ran ran = run(scene, "xpbd", sweeps, steps);
    const double off = (ran.x - newton).cwiseAbs().maxCoeff(),
                 correction = ran.last.solver.values.at("xpbd_correction_m");
    EXPECT_EQ(off < 1e-10, sweeps == 200) << off;
    EXPECT_EQ(correction < 1e-10, sweeps == 200) << correction;
    EXPECT_EQ(run(scene, "xpbd", sweeps, steps).x, ran.x);
    EXPECT_EQ(ran.x.col(0), scene.x0.col(0));  // held
    EXPECT_EQ(ran.last.solver.values.at("xpbd_sweeps"), sweeps);
    EXPECT_EQ(ran.last.solver.values.at("xpbd_constraints"), n_vertices - 1);
  }
}

/// A chain that swings down from the level: what a change did along gradients that have turned since is of second order in
/// the length of a step.
TEST(Xpbd, a_chain_that_swings_is_off_by_the_turn_of_its_gradients_in_a_step) {
  const Scene scene = chain(1, level, true, false);
  double off[2];
  for (const int halved : {0, 1}) {
    const double step = halved ? dt / 2 : dt;
    const int steps = halved ? 20 : 10;
    const Positions newton = run(scene, "line_search", 200, steps, step).x;
    off[halved] = (run(scene, "xpbd", 500, steps, step).x - newton).cwiseAbs().maxCoeff();
    const double motion = (newton - scene.x0).cwiseAbs().maxCoeff();
    EXPECT_GT(motion, 0.05);
    EXPECT_LT(off[halved], 2e-3 * motion);
  }
  EXPECT_GT(off[0], 3.5 * off[1]);
  EXPECT_LT(off[0], 4.7 * off[1]);
}

TEST(Xpbd, a_chain_that_falls_faster_than_it_can_see_stays_above_the_floor) {
  const double height = 0.05;
  for (const bool floor : {true, false}) {
    const Scene scene = chain(height, level, false, floor, 20);
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
    // No iterate was linearised, and yet the end of a step has the barrier of its rows.
    EXPECT_EQ(ran.last.kappa_max_N_per_m.value, 100);
    EXPECT_GT(ran.last.contact_load_max_N.value, 0);
  }
}

/// What the floor pushed in the first sweeps, and the springs then pull away, is given back.
TEST(Xpbd, a_contact_that_does_not_last_leaves_nothing) {
  // the lowest vertex is 2 mm over the floor, and would be 2 mm below it
  const auto end = [](bool floor) { return run(chain(0.502, down, true, floor, 0.3, 2e4), "xpbd", 2000, 1); };
  const Ran with = end(true), without = end(false);
  const double predicted = 0.002 - 0.3 * dt - 10 * dt * dt;
  ASSERT_LT(predicted, -1e-3);
  ASSERT_GT(without.x.row(2).minCoeff(), 1e-3);  // the springs hold it
  EXPECT_EQ(with.last.solver.values.at("xpbd_constraints"), n_vertices);
  EXPECT_LT((with.x - without.x).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Xpbd, makes_no_linear_solver_and_compares_no_energies) {
  const Scene scene = chain(1, level, true, false);
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
  const Scene cloth = builder.finish(), over = chain(1, level, false, true);
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
