// Steps of augmented_lagrangian: what multipliers hold and with which force, that they are those of the exact problem, and the
// cloth example of jaxls with the end state of its own program.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/step_solvers/registry.hpp"
#include "core/terms/contact_multipliers.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::augmented_lagrangian_test {
namespace {

constexpr double d_hat = 0.01, mass = 0.2, weight = 2, tolerance = 1e-6;  // m, kg, N, m

Method method_of(double initial = 0, const std::string& integrator = "implicit_euler") {
  Method method = test::fixed_method("log", 100, integrator);
  choose_step_solver(method, "augmented_lagrangian");
  method.step_solver.tol_velocity = 1e-8;
  method.step_solver.max_iterations = 500;
  if (initial > 0) method.step_solver.parameters["al_penalty_initial_N_per_m"] = initial;
  fit_terms(method);
  return method;
}

struct Ran {
  Positions x;
  StepReport last;
  double most_violated = 0, updates = 0;
};

Ran run(const Scene& scene, Method method, double dt, int steps) {
  Simulation simulation(scene, method, dt, steps);
  StepObserver none;
  Ran out;
  for (int i = 0; i < steps; ++i) {
    out.last = simulation.step(none);
    EXPECT_EQ(out.last.status, StepStatus::converged) << i << " " << out.last.detail;
    if (out.last.status != StepStatus::converged) break;
    out.most_violated = std::max(out.most_violated, out.last.solver.values.at("al_violation_m"));
    out.updates += out.last.solver.values.at("al_updates");
  }
  out.x = simulation.history().x;
  return out;
}

/// It rests on the plane itself with its weight as the multiplier, whatever penalty it begins with.
TEST(AugmentedLagrangian, a_weight_rests_at_contact_and_its_force_is_the_multiplier) {
  for (const double initial : {0.0, 20.0, 1e5}) {
    const Ran ran = run(test::particle_over_plane(mass, 0.5 * d_hat, d_hat), method_of(initial), 0.05, 20);
    EXPECT_NEAR(ran.x(2, 0), 0, tolerance) << initial;
    EXPECT_NEAR(ran.last.contact_load_max_N.value, weight, 1e-4 * weight) << initial;
    EXPECT_LT(ran.most_violated, tolerance) << initial;
    EXPECT_GT(ran.updates, 0) << initial;
    EXPECT_GE(ran.last.solver.values.at("al_penalty_N_per_m"), 0.999 * std::max(initial, weight / d_hat))
        << initial;
    EXPECT_EQ(ran.last.ccd_queries, 0);
  }
}

/// A fall that would end below the plane ends on it at the end of the very step; one that would not is free.
TEST(AugmentedLagrangian, contact_is_exact_within_a_step_and_felt_by_nothing_that_is_open) {
  Scene hits = test::particle_over_plane(mass, 0.9 * d_hat, d_hat);
  hits.v0(2, 0) = -3;
  EXPECT_NEAR(run(hits, method_of(), 0.01, 1).x(2, 0), 0, tolerance);
  Scene rises = test::particle_over_plane(mass, 0.5 * d_hat, d_hat);
  rises.v0(2, 0) = 0.2;
  const Ran ran = run(rises, method_of(), 0.01, 1);
  EXPECT_EQ(ran.updates, 0);
  EXPECT_NEAR(ran.x(2, 0), 0.5 * d_hat + 0.002 - 10 * 1e-4, 1e-9);
}

/// The net of jaxls's example "Cloth draping": 15 x 15 points of 10 g, springs to the next point along rows and columns, across, and
/// to the one after the next, a ball on a table.
Scene net_over_ball() {
  constexpr int n = 15;
  Scene scene;
  scene.name = "net";
  scene.bodies = {{"net", 0, n * n}};
  scene.x0.setZero(3, n * n);
  const auto at = [](int row, int column) { return n * row + column; };
  const auto join = [&](int a, int b, double stiffness, double length) {
    scene.stitches.pairs.push_back({a, b});
    scene.stitches.stiffness.push_back(stiffness);
    scene.stitches.rest_length.push_back(length);
  };
  for (int r = 0; r < n; ++r) {
    for (int c = 0; c < n; ++c) {
      scene.x0.col(at(r, c)) = Vec3d(0.1 * c + 0.15, 0.1 * r + 0.05, 2.2);
      scene.surface_vertices.push_back(at(r, c));
      for (const int far : {1, 2}) {
        const double stiffness = far == 1 ? 50 : 10;
        if (c + far < n) join(at(r, c), at(r, c + far), stiffness, 0.1 * far);
        if (r + far < n) join(at(r, c), at(r + far, c), stiffness, 0.1 * far);
      }
      if (r + 1 == n) continue;
      if (c + 1 < n) join(at(r, c), at(r + 1, c + 1), 25, 0.1 * std::sqrt(2.0));
      if (c > 0) join(at(r, c), at(r + 1, c - 1), 25, 0.1 * std::sqrt(2.0));
    }
  }
  scene.rest = scene.x0;
  scene.v0.setZero(3, n * n);
  scene.mass.assign(n * n, 0.01);
  scene.body.assign(n * n, 0);
  scene.d_hat.assign(n * n, 0.01);
  scene.offset.assign(n * n, 0);
  scene.gravity = Vec3d(0, 0, -9.81);
  scene.damping = {std::pow(0.95, 30), std::pow(0.7, 30)};
  Obstacle table, ball;
  table.name = "table";
  ball.name = "ball";
  ball.kind = ObstacleKind::sphere;
  ball.point = Vec3d(0.7, 0.7, 0.35);
  ball.radius = 0.35;
  scene.obstacles = {table, ball};
  return scene;
}

/// jaxls itself (its example at commit 50a58be, float, 2026-11-26): the mean of the points, m, and the highest and the lowest one
/// after some steps of 1/30 s. Its page states -0.000 and 0.176 for the heights of its end, 150 steps; run here it prints -0.000 and
/// 0.226. The net still slides off the ball then, so the end has to lie between the two.
TEST(AugmentedLagrangian, a_net_falls_over_a_ball_as_in_the_program_of_jaxls) {
  struct Known {
    int steps;
    Vec3d mean;
    double lowest, highest, within;
  };
  const Known known[] = {{19, {0.85, 0.75, 1.4185}, 1.4185, 1.4185, 1e-4},
                         {31, {0.84995, 0.74998, 0.49608}, 0.46971, 0.6912, 2e-3},
                         {41, {0.84271, 0.73925, 0.28291}, 0, 0.69825, 1e-2}};
  const Scene scene = net_over_ball();
  ASSERT_EQ(scene.stitches.pairs.size(), 1202U);
  Method method = method_of(0, "half_gravity");
  method.step_solver.tol_velocity = 1e-5;
  Simulation simulation(scene, method, 1.0 / 30, 150);
  StepObserver none;
  int step = 0;
  double most_violated = 0;
  const auto advance = [&] {
    const StepReport report = simulation.step(none);
    ASSERT_EQ(report.status, StepStatus::converged) << step << " " << report.detail;
    most_violated = std::max(most_violated, report.solver.values.at("al_violation_m"));
  };
  for (const Known& then : known) {
    for (; step < then.steps; ++step) advance();
    const Positions& x = simulation.history().x;
    EXPECT_LT((x.rowwise().mean() - then.mean).norm(), then.within)
        << step << ": " << x.rowwise().mean().transpose();
    EXPECT_NEAR(x.row(2).minCoeff(), then.lowest, then.within) << step;
    EXPECT_NEAR(x.row(2).maxCoeff(), then.highest, then.within) << step;
  }
  for (; step < 150; ++step) advance();
  const auto heights = simulation.history().x.row(2);
  EXPECT_NEAR(heights.minCoeff(), 0, 2 * tolerance);
  EXPECT_GT(heights.maxCoeff(), 0.176);
  EXPECT_LT(heights.maxCoeff(), 0.226);
  EXPECT_LT(most_violated, tolerance);
}

/// The rules of an update, one by one.
TEST(ContactMultipliers, grow_where_violated_keep_to_zero_where_open_and_penalties_follow_progress) {
  ContactMultipliers multipliers({.initial = 100});
  multipliers.begin_step();
  ContactTable rows;
  rows.resize(1);
  rows.d_hat[0] = d_hat;
  const MollifiedTable none;
  const auto at = [&](double d) { rows.d[0] = d, multipliers.fill(rows); };
  at(0.5 * d_hat);
  EXPECT_EQ(rows.kappa[0], 100);
  EXPECT_EQ(rows.b[0], 0);
  EXPECT_EQ(rows.d2b[0], 0);
  EXPECT_FALSE(multipliers.update(rows, none));  // open, and nothing pushes
  at(-1e-3);
  EXPECT_DOUBLE_EQ(rows.kappa[0] * rows.db[0], -0.1);
  EXPECT_TRUE(multipliers.update(rows, none));  // lambda = 0.1, and rho grows: it was not violated before
  at(0);
  EXPECT_EQ(rows.kappa[0], 400);
  EXPECT_DOUBLE_EQ(-rows.kappa[0] * rows.db[0], 0.1);
  EXPECT_DOUBLE_EQ(rows.kappa[0] * rows.b[0], 0.1 * 0.1 / (2 * 400));
  at(-0.4e-3);
  EXPECT_TRUE(multipliers.update(rows, none));  // less than half of what it was: rho stays
  at(0);
  EXPECT_EQ(rows.kappa[0], 400);
  EXPECT_DOUBLE_EQ(-rows.kappa[0] * rows.db[0], 0.1 + 0.4e-3 * 400);
  at(0.5e-6);
  EXPECT_FALSE(multipliers.update(rows, none));  // within the tolerance: what it holds stays
  at(0);
  EXPECT_DOUBLE_EQ(-rows.kappa[0] * rows.db[0], 0.26);
  at(0.9 * d_hat);
  EXPECT_EQ(rows.db[0], 0);
  EXPECT_FALSE(multipliers.update(rows, none));  // open beyond lambda/rho: nothing pushes there
  multipliers.begin_step();
  at(0);
  EXPECT_EQ(rows.kappa[0], 100);
  // a force that reaches d_hat makes rho grow, so that nothing acts beyond
  at(-0.5 * d_hat);
  multipliers.update(rows, none);
  at(-10 * d_hat);
  multipliers.update(rows, none);
  at(d_hat);
  EXPECT_NEAR(rows.b[0], 0, 1e-18);
}

}  // namespace
}  // namespace bb::augmented_lagrangian_test
