// Steps of al_barrier: where its multipliers act and what they hold, that without tiny gaps it is line_search, and the rules of its
// updates one by one.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <cmath>
#include <vector>

#include "core/step_solvers/registry.hpp"
#include "core/terms/barrier_multipliers.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::al_barrier_test {
namespace {

constexpr double d_hat = 0.01, mass = 0.2, weight = 2;  // m, kg, N

Method method_of(double kappa, const std::string& solver = "al_barrier") {
  Method method = test::fixed_method("log", kappa);
  choose_step_solver(method, solver);
  method.step_solver.tol_velocity = 1e-9;
  method.step_solver.max_iterations = 500;
  fit_terms(method);
  return method;
}

struct Ran {
  Positions x;
  StepReport last;
  double updates = 0, releases = 0, stiffening = 1;
  int iterations = 0;
  double pressed = 0;  // N, by what the last step accelerated it
};

Ran run(const Scene& scene, Method method, double dt, int steps) {
  Simulation simulation(scene, method, dt, steps);
  StepObserver none;
  Ran out;
  for (int i = 0; i < steps; ++i) {
    const double before = simulation.history().v(2, 0);
    out.last = simulation.step(none);
    out.pressed = mass * (10 + (simulation.history().v(2, 0) - before) / dt);
    EXPECT_EQ(out.last.status, StepStatus::converged) << i << " " << out.last.detail;
    if (out.last.status != StepStatus::converged) break;
    out.iterations += out.last.newton_iterations;
    if (method.step_solver.name != "al_barrier") continue;
    out.updates += out.last.solver.values.at("al_barrier_updates");
    out.releases += out.last.solver.values.at("al_barrier_releases");
    out.stiffening = std::max(out.stiffening, out.last.solver.values.at("al_barrier_stiffening"));
  }
  out.x = simulation.history().x;
  return out;
}

/// A barrier that is too soft by far: what carries the weight is the multiplier, the barrier of A' and the stiffness that they
/// have grown to, and their sum is the weight.
TEST(AlBarrier, a_weight_on_a_barrier_that_is_too_soft_is_carried_by_multiplier_and_barrier_together) {
  const double kappa = 0.02;
  const Ran ran = run(test::particle_over_plane(mass, 0.5 * d_hat, d_hat), method_of(kappa), 0.05, 20);
  const double gap = ran.x(2, 0);
  EXPECT_GT(ran.updates, 0);
  EXPECT_NEAR(ran.last.contact_load_max_N.value, weight, 5e-3 * weight);  // every step ends at another gap
  EXPECT_NEAR(ran.last.contact_load_max_N.value, ran.pressed, 1e-6 * weight);
  EXPECT_GT(gap, 1e-2 * d_hat);  // the log alone would let it down to 1e-4 d_hat
  const Ran soft =
      run(test::particle_over_plane(mass, 0.5 * d_hat, d_hat), method_of(kappa, "line_search"), 0.05, 20);
  EXPECT_LT(soft.x(2, 0), 2e-4 * d_hat);
  EXPECT_NEAR(soft.last.contact_load_max_N.value, weight, 1e-6 * weight);
  // closed form: mu |w'| + n s kappa |b'(d)| = m (g + a), n = 2 for a pair of A'
  const double force = ran.last.solver.values.at("al_barrier_force_N");
  const double scale = ran.last.solver.values.at("al_barrier_stiffening");
  const ShapeTerms<double> b = BarrierFunction{require_shape("log"), Argument::gap}.eval(gap, d_hat);
  const double held = -fade(gap, d_hat).slope * force - (force > 0 ? 2 : 1) * scale * kappa * b.db;
  EXPECT_NEAR(held, ran.pressed, 1e-6 * weight) << gap / d_hat << " " << force << " " << scale;
}

/// Above the threshold nothing is touched: not a bit differs from line_search.
TEST(AlBarrier, is_line_search_where_no_gap_is_tiny) {
  Scene scene = test::particle_over_plane(mass, 0.5 * d_hat, d_hat);
  const Ran one = run(scene, method_of(100), 0.01, 20);
  const Ran other = run(scene, method_of(100, "line_search"), 0.01, 20);
  EXPECT_EQ(one.updates, 0);
  EXPECT_GT(one.last.contact_load_max_N.value, 0.5 * weight);
  EXPECT_EQ(one.x, other.x);
  EXPECT_EQ(one.iterations, other.iterations);
}

/// An impact that leaves tiny gaps takes fewer iterations than the barrier alone, and never comes through.
TEST(AlBarrier, an_impact_ends_above_the_plane) {
  Scene scene = test::particle_over_plane(mass, 0.9 * d_hat, d_hat);
  scene.v0(2, 0) = -30;
  const Ran ran = run(scene, method_of(1), 0.01, 3);
  EXPECT_GT(ran.x(2, 0), 0);
  EXPECT_GT(ran.updates, 0);
  EXPECT_GT(ran.releases, 0);
}

/// Cloth that falls on a plane: the same bits with one thread and with three.
TEST(AlBarrier, does_not_depend_on_the_number_of_threads) {
  SceneBuilder builder("cloth on a floor", false, Vec3d(0, 0, -10), "test");
  builder.add_body(test::cloth_spec(6, 0.5 * d_hat, d_hat));
  Obstacle plane;
  plane.name = "floor";
  builder.add_obstacle(plane);
  const Scene scene = builder.finish();
  Positions end[2];
  double updates = 0;
  for (const int threads : {1, 3}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                            static_cast<std::size_t>(threads));
    const Ran ran = run(scene, method_of(1e-3), 0.02, 4);
    end[threads == 1 ? 0 : 1] = ran.x;
    updates = ran.updates;
  }
  EXPECT_GT(updates, 0);
  EXPECT_EQ(end[0], end[1]);
}

/// What it holds is the multiplier of the pair, and where that fades its two derivatives are those of its value.
TEST(BarrierMultipliers, fade_out_without_a_jump) {
  for (const double d : {0.1, 0.3, 0.499, 0.6, 0.9, 0.999}) {
    const double at = d * d_hat, step = 1e-7 * d_hat;
    const Fade below = fade(at - step, d_hat), above = fade(at + step, d_hat), here = fade(at, d_hat);
    EXPECT_NEAR((above.value - below.value) / (2 * step), here.slope, 1e-6) << d;
    EXPECT_NEAR((above.slope - below.slope) / (2 * step), here.curvature, 1e-6 / d_hat) << d;
  }
  EXPECT_EQ(fade(0.2 * d_hat, d_hat).slope, -1);
  EXPECT_EQ(fade(d_hat, d_hat).value, 0);
  EXPECT_NEAR(fade(0.5 * d_hat, d_hat).value, fade(0.5 * d_hat - 1e-15, d_hat).value, 1e-14);
}

TEST(BarrierMultipliers, take_up_what_is_near_grow_by_the_force_of_their_barrier_and_go_where_all_is_wide) {
  BarrierMultipliers multipliers({});
  multipliers.begin_step();
  ContactTable rows;
  rows.resize(2);
  const MollifiedTable none;
  const BarrierFunction log{require_shape("log"), Argument::gap};
  const auto at = [&](double first, double second) {
    const double d[] = {first * d_hat, second * d_hat};
    for (std::size_t r = 0; r < 2; ++r) {
      const ShapeTerms<double> b = log.eval(d[r], d_hat);
      rows.pair[r] = r, rows.d[r] = d[r], rows.d_hat[r] = d_hat, rows.kappa[r] = 3;
      rows.b[r] = b.b, rows.db[r] = b.db, rows.d2b[r] = b.d2b;
    }
    multipliers.add(rows);
  };
  const auto plain = [&](double d) { return -3 * log.eval(d * d_hat, d_hat).db; };
  at(0.02, 0.5);
  EXPECT_EQ(-rows.kappa[0] * rows.db[0], plain(0.02));
  EXPECT_FALSE(multipliers.update(rows, none));
  at(0.005, 0.5);
  EXPECT_TRUE(multipliers.update(rows, none));
  EXPECT_EQ(multipliers.counts().pairs_most, 1);
  EXPECT_DOUBLE_EQ(multipliers.counts().force_N, plain(0.005));
  at(0.005, 0.5);  // the multiplier, and the barrier twice and stiffer; the other row is stiffer alone
  EXPECT_NEAR(-rows.kappa[0] * rows.db[0], plain(0.005) + 2 * 1.2 * plain(0.005), 1e-9 * plain(0.005));
  EXPECT_NEAR(-rows.kappa[1] * rows.db[1], 1.2 * plain(0.5), 1e-12);
  at(0.006, 0.008);  // wider than before: nobody joins
  EXPECT_TRUE(multipliers.update(rows, none));
  EXPECT_EQ(multipliers.counts().pairs_most, 1);
  EXPECT_NEAR(multipliers.counts().force_N, plain(0.005) + 1.2 * plain(0.006), 1e-9 * plain(0.006));
  at(0.004, 0.008);
  EXPECT_TRUE(multipliers.update(rows, none));
  EXPECT_EQ(multipliers.counts().pairs_most, 2);
  at(0.05, 0.5);
  EXPECT_FALSE(multipliers.update(rows, none));  // between near and release
  at(0.2, 0.5);
  EXPECT_TRUE(multipliers.update(rows, none));
  EXPECT_EQ(multipliers.counts().releases, 1);
  at(0.2, 0.5);
  EXPECT_NEAR(-rows.kappa[0] * rows.db[0], 1.2 * 1.2 * 1.2 * plain(0.2),
              1e-12);  // the stiffness stays in the step
  multipliers.begin_step();
  at(0.2, 0.5);
  EXPECT_EQ(-rows.kappa[0] * rows.db[0], plain(0.2));
}

TEST(AlBarrier, refuses_a_release_that_is_no_wider_than_near) {
  Method method = test::fixed_method("log", 1);
  choose_step_solver(method, "al_barrier");
  method.step_solver.parameters["al_barrier_release"] = 0.01;
  EXPECT_THROW(fit_terms(method), ConfigError);
}

}  // namespace
}  // namespace bb::al_barrier_test
