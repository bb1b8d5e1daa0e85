// Steps of penalty: how deep a load rests, that the barrier goes on below contact, what passes through, what the plan leaves out.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/step_solvers/registry.hpp"
#include "tests/newton/converged_steps.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::penalty_test {
namespace {

constexpr double d_hat = 0.01, mass = 0.2, weight = 2;  // m, kg, N

Method penalty(double k, const std::string& shape = "quadratic") {
  Method method = test::fixed_method(shape, k / 2);
  choose_step_solver(method, "penalty");
  method.step_solver.tol_velocity = 1e-9;
  fit_terms(method);
  return method;
}

struct Ran {
  Positions x;
  StepReport last;
  double deepest = 0;  // m, over the steps
};

Ran run(const Scene& scene, Method method, double dt, int steps) {
  Ran out;
  out.x = test::converged_steps(scene, method, dt, steps, [&out](const StepReport& report) {
    out.last = report;
    if (report.solver.values.contains("penalty_overlap_m"))
      out.deepest = std::max(out.deepest, report.solver.values.at("penalty_overlap_m"));
  });
  return out;
}

/// d = d_hat - weight/k, above the plane or below it; the quadratic is a spring of stiffness 2 kappa on both sides.
TEST(Penalty, a_weight_rests_where_the_spring_bears_it_below_the_surface_too) {
  for (const double k : {800.0, 250.0, 50.0}) {
    const Scene scene = test::particle_over_plane(mass, 0.9 * d_hat, d_hat);
    const Ran ran = run(scene, penalty(k), 0.05, 800);
    const double gap = d_hat - weight / k, overlap = std::max(0.0, -gap);
    EXPECT_NEAR(ran.x(2, 0), gap, 1e-6) << k;
    EXPECT_NEAR(ran.last.solver.values.at("penalty_overlap_m"), overlap, 1e-6) << k;
    EXPECT_EQ(ran.last.solver.values.at("penalty_overlaps"), k == 50 ? 1 : 0) << k;
    EXPECT_GE(ran.deepest, overlap);
  }
}

/// Of every shape that has no pole, in closed form.
TEST(Penalty, bounded_shapes_go_on_below_contact_by_their_formula) {
  const double d = -0.7 * d_hat, e = d_hat - d;
  const ShapeTerms<double> quadratic = BarrierFunction{require_shape("quadratic")}.eval(d, d_hat),
                           cubic = BarrierFunction{require_shape("cubic")}.eval(d, d_hat);
  EXPECT_DOUBLE_EQ(quadratic.b, e * e);
  EXPECT_DOUBLE_EQ(quadratic.db, -2 * e);
  EXPECT_DOUBLE_EQ(quadratic.d2b, 2);
  EXPECT_NEAR(cubic.b, 2 / (3 * d_hat) * e * e * e, 1e-15);
  EXPECT_NEAR(cubic.db, -2 / d_hat * e * e, 1e-14);
  EXPECT_NEAR(cubic.d2b, 4 / d_hat * e, 1e-12);
}

/// What an obstacle with an inside pushes back, a sheet without thickness lets through: there d has no sign.
TEST(Penalty, what_is_faster_than_d_hat_a_step_comes_out_behind_a_sheet) {
  const auto end = [](bool sheet, const std::string& solver, double k) {
    SceneBuilder builder("shot", false, Vec3d::Zero(), "test");
    BodySpec bead;
    bead.name = "bead";
    bead.mesh.vertices = test::one_point(0.4, 0.3, 0.05);
    bead.mesh.vertices.conservativeResize(3, 2);
    bead.mesh.vertices.col(1) = Vec3d(0.4, 0.3, 0.06);
    bead.mesh.segments.push_back({0, 1});
    bead.material.line_density = 1;
    bead.material.springs = 100;
    bead.material.model = "none";
    bead.velocity = Vec3d(0, 0, -10);
    bead.d_hat = d_hat;
    builder.add_body(bead);
    if (sheet) {
      BodySpec wall = test::cloth_spec(3, 0, d_hat);
      wall.kind = BodyKind::rigid;
      builder.add_body(wall);
    } else {
      Obstacle plane;
      plane.name = "floor";
      builder.add_obstacle(plane);
    }
    Method method = penalty(k);
    choose_step_solver(method, solver);
    fit_terms(method);
    return run(builder.finish(), std::move(method), 0.01, 3);
  };
  EXPECT_LT(end(true, "penalty", 1e5).x(2, 0), -0.1);
  EXPECT_GT(end(true, "line_search", 1e5).x(2, 0), 0);
  const Ran floor = end(false, "penalty", 1e2);
  EXPECT_GT(floor.deepest, 0.01);
  EXPECT_GT(floor.x(2, 0), -0.2);
  EXPECT_GT(end(false, "penalty", 1e5).x(2, 0), 0);
}

TEST(Penalty, has_no_step_bound_and_ends_in_a_minimum) {
  const Scene scene = test::particle_over_plane(mass, 0.9 * d_hat, d_hat);
  const Method method = penalty(100);
  const Plan plan = make_plan(scene, method, plan_options(method));
  EXPECT_FALSE(plan.step_bound.needed);
  EXPECT_TRUE(plan.trial_energies.needed);
  const Ran ran = run(scene, penalty(100), 0.05, 3);
  EXPECT_GT(ran.last.contacts.total(), 0U);
  EXPECT_EQ(ran.last.ccd_queries, 0);
  EXPECT_TRUE(ran.last.end_error_m.finite());
  EXPECT_GT(ran.last.newton_iterations, 0);
}

}  // namespace
}  // namespace bb::penalty_test
