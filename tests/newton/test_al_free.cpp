// Steps of al_free: that multipliers become the forces of the exact problem and stay, which pairs become constraints and when they
// go, that the committed motion never crosses whatever the speed is, and what is refused.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <cmath>
#include <vector>

#include "core/base/archive/archive.hpp"
#include "core/contact/motion_pairs.hpp"
#include "core/contact/step_bound.hpp"
#include "core/math/error.hpp"
#include "core/step_solvers/registry.hpp"
#include "core/terms/linear_contact.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::al_free_test {
namespace {

constexpr double d_hat = 0.01, mass = 0.2, weight = 2, standoff = 0.1 * d_hat;  // m, kg, N, m

Method method_of(double settled = 1, double penalty = 0) {
  Method method = test::fixed_method("log", 1);
  choose_step_solver(method, "al_free");
  method.step_solver.tol_velocity = 1e-8;
  method.step_solver.max_iterations = 2000;
  method.step_solver.saddle = SaddleRule::ignore;
  method.step_solver.parameters["al_free_settled"] = settled;
  if (penalty > 0) method.step_solver.parameters["al_free_penalty_N_per_m"] = penalty;
  fit_terms(method);
  return method;
}

/// Watches the smallest height of the motions that are committed.
struct Lowest final : StepObserver {
  double height = INFINITY;
  int motions = 0;
  void on_motion(const Positions& x0, const Positions& x1, int) override {
    height = std::min({height, x0.row(2).minCoeff(), x1.row(2).minCoeff()});
    ++motions;
  }
};

struct Ran {
  Positions x;
  StepReport last;
  std::vector<double> force;  // largest multiplier, step by step
  double admitted = 0, known = 0, dropped = 0;
  Lowest lowest;
};

Ran run(const Scene& scene, Method method, double dt, int steps) {
  Simulation simulation(scene, method, dt, steps);
  Ran out;
  for (int i = 0; i < steps; ++i) {
    out.last = simulation.step(out.lowest);
    EXPECT_EQ(out.last.status, StepStatus::converged) << i << " " << out.last.detail;
    const auto& said = out.last.solver.values;
    out.force.push_back(said.at("al_free_force_N"));
    if (out.last.status != StepStatus::converged) break;
    out.admitted += said.at("al_free_admitted");
    out.dropped += said.at("al_free_dropped");
    out.known += said.at("al_free_bounds_known");
  }
  out.x = simulation.history().x;
  return out;
}

/// A thick particle, however fast it comes, stays above the floor by its thickness, and rests at the standoff from there.
TEST(AlFree, a_thick_particle_is_stopped_by_its_thickness) {
  const double thick = 5 * d_hat;
  for (const double speed : {0.0, 1.0, 100.0}) {
    Scene scene = test::particle_over_plane(mass, thick + 0.9 * d_hat, d_hat);
    scene.offset = {thick};
    scene.v0(2, 0) = -speed;
    const Ran ran = run(scene, method_of(), 0.05, 20);
    EXPECT_GT(ran.lowest.height, thick) << speed;
    EXPECT_GT(ran.lowest.motions, 0);
    if (speed == 0) {
      EXPECT_NEAR(ran.x(2, 0), thick + standoff, 1e-8);
    }
  }
}

/// It rests at the standoff with its weight as the multiplier, whatever the penalty is, and that is found in the step in which it
/// comes there.
TEST(AlFree, a_weight_rests_at_the_standoff_and_its_multiplier_is_the_weight) {
  for (const double penalty : {0.0, 10.0, 1e4}) {
    const Ran ran = run(test::particle_over_plane(mass, 0.5 * d_hat, d_hat), method_of(1, penalty), 0.05, 20);
    EXPECT_NEAR(ran.x(2, 0), standoff, 1e-8) << penalty;
    EXPECT_NEAR(ran.force.back(), weight, 1e-5 * weight) << penalty;
    EXPECT_NEAR(ran.last.contact_load_max_N.value, weight, 1e-5 * weight) << penalty;
    EXPECT_EQ(ran.admitted, 1) << penalty;  // one pair, once
    EXPECT_EQ(ran.last.solver.values.at("al_free_constraints"), 1) << penalty;
    EXPECT_LT(ran.last.solver.values.at("al_free_violation_m"), 1e-8) << penalty;
    EXPECT_GT(ran.lowest.height, 0) << penalty;
    EXPECT_LT(ran.last.end_error_tolerances.value, 5) << penalty;  // by a Newton direction at the end itself
  }
}

/// An observer takes a motion for that of the iteration that it saw last.
TEST(AlFree, an_iteration_is_shown_before_its_motion) {
  struct Order final : StepObserver {
    int motions = 0;
    bool ends_with_motion = false;
    void on_iteration(const IterationReport&) override { ends_with_motion = false; }
    void on_motion(const Positions&, const Positions&, int) override { ++motions, ends_with_motion = true; }
  } order;
  const Scene scene = test::particle_over_plane(mass, 0.5 * d_hat, d_hat);
  Method method = method_of();
  Simulation simulation(scene, method, 0.05, 1);
  EXPECT_EQ(simulation.step(order).status, StepStatus::converged);
  EXPECT_GT(order.motions, 1);
  EXPECT_TRUE(order.ends_with_motion);
}

/// The multiplier goes to the load as the update says: of a free mass M/h^2 = m the error shrinks by m/(m + mu) an update.
TEST(AlFree, the_multiplier_converges_as_fast_as_mass_and_penalty_say) {
  const double dt = 0.05, m = mass / (dt * dt), penalty = 3 * m;
  const Scene scene = test::particle_over_plane(mass, 0.0005, d_hat);
  Method method = method_of(0, penalty);
  method.step_solver.parameters["al_free_first"] = std::int64_t{12};
  method.step_solver.parameters["al_free_recovery_m_per_s"] =
      1e6;  // it is lifted to the standoff in one step
  fit_terms(method);
  const Ran ran = run(scene, std::move(method), dt, 1);
  // the step that lifts it to the standoff: the multiplier is m (standoff - x_tilde), x_tilde = x_n - g h^2
  const double exact = m * (standoff - (0.0005 - 10 * dt * dt));
  const double shrinks = m / (m + penalty), outer = ran.last.solver.values.at("al_free_outer");
  ASSERT_EQ(outer, 12);
  // it is admitted in the first outer iteration, and updated in all that follow
  EXPECT_NEAR(1 - ran.force.back() / exact, std::pow(shrinks, outer - 1),
              1e-3 * std::pow(shrinks, outer - 1));
}

/// What falls through the whole plane in one step is a constraint at once and stops, however far it was away.
TEST(AlFree, a_fall_of_many_d_hat_in_a_step_stops_above_the_plane) {
  Scene scene = test::particle_over_plane(mass, 10 * d_hat, d_hat);
  scene.v0(2, 0) = -300;
  const Ran ran = run(scene, method_of(1, 1e5), 0.01, 1);
  EXPECT_NEAR(ran.x(2, 0), standoff, 1e-8);
  EXPECT_EQ(ran.admitted, 1);
  EXPECT_GT(ran.lowest.height, 0);
  EXPECT_GT(ran.lowest.motions, 1);
}

/// A pair that is not pressed any more pulls on nothing, and goes.
TEST(AlFree, a_constraint_that_is_left_alone_goes_without_holding_anything_back) {
  Scene scene = test::particle_over_plane(mass, 1.001 * standoff, d_hat);
  Method method = method_of();
  method.step_solver.parameters["al_free_decay"] = 0.5;
  fit_terms(method);
  scene.v0(2, 0) = -1;
  Simulation simulation(scene, method, 0.01, 40);
  Lowest lowest;
  EXPECT_GT(simulation.step(lowest).solver.values.at("al_free_force_N"), 0);
  Positions v = simulation.history().v;
  EXPECT_LT(std::abs(v(2, 0)), 0.02);
  scene.gravity = Vec3d(0, 0, 10);  // upwards from here on: the scene is read at every step
  double dropped = 0;
  StepReport last;
  for (int i = 0; i < 10; ++i) {
    last = simulation.step(lowest);
    dropped += last.solver.values.at("al_free_dropped");
  }
  EXPECT_EQ(dropped, 1);
  EXPECT_EQ(last.solver.values.at("al_free_constraints"), 0);
  const double z = simulation.history().x(2, 0), t = 0.1;  // ten implicit steps: t (t + h)/2
  EXPECT_NEAR(z - standoff, v(2, 0) * t + 10 * t * (t + 0.01) / 2, 1e-7);
}

Scene cloth_on(bool floor, int n) {
  SceneBuilder builder("cloth", false, Vec3d(0, 0, -10), "test");
  BodySpec top = test::cloth_spec(n, 0.012, d_hat), below = test::cloth_spec(n - 1, 0.004, d_hat);
  below.name = "below";
  const Mat3d turn = Eigen::AngleAxisd(0.3, Vec3d::UnitZ()).toRotationMatrix();  // no edges in parallel
  below.mesh.vertices = turn * below.mesh.vertices;
  top.velocity = Vec3d(0, 0, -3);
  builder.add_body(top);
  builder.add_body(below);
  Obstacle plane;
  plane.name = "floor";
  if (floor) builder.add_obstacle(plane);
  return builder.finish();
}

/// Two sheets fall on each other and on a floor: contacts of all kinds, the same bits with one thread and with three.
TEST(AlFree, sheets_come_to_lie_on_each_other_and_no_bit_depends_on_threads) {
  const Scene scene = cloth_on(true, 6);
  Positions end[2];
  double constraints = 0;
  for (const int threads : {1, 3}) {
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                            static_cast<std::size_t>(threads));
    const Ran ran = run(scene, method_of(0), 0.01, 6);
    end[threads == 1 ? 0 : 1] = ran.x;
    constraints = ran.last.solver.values.at("al_free_constraints");
    EXPECT_GT(ran.lowest.height, 0);
    EXPECT_GT(ran.last.gap_min_m.value, 0);
  }
  EXPECT_GT(constraints, 20);
  EXPECT_EQ(end[0], end[1]);
}

/// The weight of the sheets is what the floor carries.
TEST(AlFree, what_the_floor_carries_is_the_weight_of_all_that_lies_on_it) {
  const Scene scene = cloth_on(true, 4);
  Method method = method_of(10, 1e3);
  method.step_solver.tol_velocity = 1e-5;
  const Ran ran = run(scene, std::move(method), 0.02, 40);
  double carried = 0, all = 0;
  for (const double m : scene.mass) all += 10 * m;
  for (const ContactLoad& load : ran.last.contact_loads) {
    if (std::any_of(load.key.begin(), load.key.end(), [](int id) { return obstacle_of(id) >= 0; }))
      carried += load.load_N;
  }
  EXPECT_NEAR(carried, all, 2e-3 * all);
}

/// All pairs that stop a motion: the earliest is that of the step bound, bit for bit, and every one of them is a stop.
TEST(MotionPairs, their_earliest_is_the_step_bound_and_gaps_are_linear_to_first_order) {
  const Scene scene = cloth_on(true, 6);
  ContactOptions options;
  options.mollifier = Mollifier::none;
  const ContactPlan plan = plan_contact(scene, Mollifier::none);
  MotionPairs pairs(scene, options, plan);
  ContactSystem system(scene, options, plan);
  Positions to = scene.x0;
  for (Eigen::Index i = 0; i < to.cols(); ++i) {
    const double at = static_cast<double>(i);
    to.col(i) +=
        Vec3d(2e-3 * std::sin(3 * at), 2e-3 * std::cos(5 * at),
              (scene.body[static_cast<std::size_t>(i)] == 0 ? -0.03 : -0.006) + 1e-3 * std::sin(7 * at));
  }
  const std::vector<MotionHit>& hits = pairs.hits(scene.x0, to);
  system.update_candidates(scene.x0, to);
  const StepBound bound = system.step_bound(scene.x0, to);
  ASSERT_GT(hits.size(), 30U);
  EXPECT_EQ(pairs.earliest().alpha, bound.alpha);
  EXPECT_EQ(pairs.earliest().key, bound.key);
  EXPECT_LT(bound.alpha, 1);
  int compared = 0, of_list[7] = {};
  for (const MotionHit& hit : hits) {
    const LinearGap gap = pairs.gap(hit.pair, scene.x0);
    EXPECT_GT(gap.d, 0);
    ++of_list[pair_list(hit.pair)];
    const double step = 1e-6;
    const Positions moved = scene.x0 + step * (to - scene.x0) / (to - scene.x0).norm();
    double opening = 0, of_all = 0;
    for (std::size_t k = 0; k < 4 && gap.vertex[k] >= 0; ++k) {
      opening += gap.weight[k] * gap.normal.dot(moved.col(gap.vertex[k]) - scene.x0.col(gap.vertex[k]));
      of_all += gap.weight[k];
    }
    if (pair_obstacle(hit.pair) < 0) {
      EXPECT_NEAR(of_all, 0, 1e-12);  // no force in sum
    }
    EXPECT_NEAR(pairs.gap(hit.pair, moved).d - gap.d, opening, 1e-3 * step) << hit.pair;
    compared += opening != 0;
  }
  EXPECT_GT(compared, 30);
  EXPECT_GT(of_list[static_cast<int>(PairKind::point_triangle)], 5);
  EXPECT_GT(of_list[static_cast<int>(PairKind::edge_edge)], 5);
  EXPECT_GT(of_list[obstacle_pairs], 5);
}

/// Constraints, their multipliers and how long they have been quiet go on from an archive.
TEST(AlFree, goes_on_from_an_archive_bit_for_bit) {
  const Scene scene = cloth_on(true, 4);
  Method method = method_of(0), same = method_of(0);
  Simulation whole(scene, method, 0.01, 8), later(scene, same, 0.01, 8);
  StepObserver none;
  for (int i = 0; i < 5; ++i) whole.step(none);
  Archive memory;
  whole.keep(memory);
  Archive again(memory.bytes());
  later.keep(again);
  for (int i = 5; i < 8; ++i) {
    const StepReport one = whole.step(none), other = later.step(none);
    EXPECT_GT(one.solver.values.at("al_free_force_N"), 0);
    EXPECT_EQ(one.solver.values, other.solver.values) << i;
  }
  EXPECT_EQ(whole.history().x, later.history().x);
}

TEST(AlFree, refuses_what_it_cannot_step) {
  SceneBuilder builder("limited", false, Vec3d(0, 0, -10), "test");
  BodySpec sheet = test::cloth_spec(3, 0.012, d_hat);
  sheet.material.limit = StrainLimitSpec{0.025, 0.025};
  builder.add_body(sheet);
  Obstacle plane;
  plane.name = "floor";
  builder.add_obstacle(plane);
  const Scene limited = builder.finish();
  Method method = method_of();
  EXPECT_THROW(Simulation(limited, method, 0.01, 1), ConfigError);
  Scene rough = test::particle_over_plane(mass, 0.5 * d_hat, d_hat);
  Method other = method_of();
  other.friction.mu = 0.3;
  EXPECT_THROW(Simulation(rough, other, 0.01, 1), ConfigError);
}

}  // namespace
}  // namespace bb::al_free_test
