// Load over capacity of one contact, by hand: every number that enters is known.
#include <gtest/gtest.h>

#include "core/newton/iteration.hpp"
#include "tests/contact/contact_scenes.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::overload_test {
namespace {

constexpr double d_hat = 0.01, gravity = 10, dt = 0.01;
constexpr double capacity = 2 * d_hat;  // of the cubic: sup |b'| for kappa = 1, m

/// load / capacity at the start of a step from rest, when the Newton direction is dx.
double overload(const Scene& scene, double kappa, const Positions& dx, std::size_t n_pairs = 6) {
  Method method = test::fixed_method("cubic", kappa);
  NewtonSystem system(scene, method);
  Prediction at_rest;
  at_rest.x_tilde = scene.x0;
  system.begin_step(scene.x0, at_rest, dt, 1.0);
  system.assemble();
  EXPECT_EQ(test::reported(system).contacts.total(), n_pairs);
  StepNumbers out;
  system.set_direction(dx);
  system.view().report_overload(true, out);
  return out.contact_overload.value;
}

/// A free particle of 1 kg over the middle vertex of a given plate, where six triangles meet.
Scene particle_over_a_plate() {
  Scene scene;
  const auto [vertices, triangles] = test::grid(2, 2, 1.0);
  test::add_body(scene, "plate", vertices, triangles, d_hat, true);
  test::add_body(scene, "particle", {Vec3d(1, 1, 0.4 * d_hat)}, {}, d_hat);
  scene.gravity = Vec3d(0, 0, -gravity);
  return scene;
}

TEST(Overload, pairs_of_one_feature_share_its_load) {
  const Scene scene = particle_over_a_plate();
  const double measured = overload(scene, 1, Positions::Zero(3, scene.n_vertices()));
  EXPECT_NEAR(measured, gravity / 6 / capacity, 1e-9 * measured);
  // twice the stiffness carries twice as much
  EXPECT_NEAR(overload(scene, 2, Positions::Zero(3, scene.n_vertices())), measured / 2, 1e-9 * measured);
}

/// A free triangle of 3 kg that lies with its middle on a given point: the row acts at w_i = 1/3 of each
/// vertex and has to carry the whole weight.
TEST(Overload, a_row_carries_the_weight_of_all_its_vertices) {
  Scene scene;
  test::add_body(scene, "point", {Vec3d(1, 1, 0)}, {}, d_hat, true);
  const double z = 0.4 * d_hat;
  test::add_body(scene, "triangle", {Vec3d(0, 0, z), Vec3d(3, 0, z), Vec3d(0, 3, z)}, {{0, 1, 2}}, d_hat);
  scene.gravity = Vec3d(0, 0, -gravity);
  const double measured = overload(scene, 1, Positions::Zero(3, 4), 1);
  EXPECT_NEAR(measured, 3 * gravity / capacity, 1e-9 * measured);
}

/// Newton's model of the row is linear from d on: it needs |b'(d)| + b''(d) times the closing of the gap.
TEST(Overload, the_newton_model_asks_for_the_force_at_the_end_of_its_step) {
  const Scene scene = particle_over_a_plate();
  Positions dx = Positions::Zero(3, scene.n_vertices());
  dx(2, 9) = -0.1;
  const double depth = 0.6 * d_hat;
  const double force = 2 / d_hat * depth * depth, slope = 4 / d_hat * depth;
  EXPECT_NEAR(overload(scene, 1e9, dx), (force + slope * 0.1) / capacity, 1e-9);
  dx(2, 9) = 0.1;  // opens: only the weight is left, of which so stiff a row carries any
  EXPECT_LT(overload(scene, 1e9, dx), 1e-6);
}

/// A system at the start of a step from rest, on its way to a pose of the plate that is `rise` higher.
struct Rising {
  Scene scene = particle_over_a_plate();
  Method method = test::fixed_method("cubic", 1e3);
  NewtonSystem system{scene, method};

  explicit Rising(double rise) {
    Prediction at_rest;
    at_rest.x_tilde = scene.x0;
    system.begin_step(scene.x0, at_rest, dt, 1.0);
    Positions target = scene.x0;
    target.row(2).array() += rise;
    system.set_target(target);
    system.assemble();
  }
  StepReport measured(StepStatus status) {
    StepReport out;
    out.status = status;
    measure_end(system, out);
    return out;
  }
};

constexpr StepStatus stalled[] = {StepStatus::iteration_cap, StepStatus::step_collapse,
                                  StepStatus::line_search_failed, StepStatus::not_descent};

/// What the barrier has to carry where the step got nowhere: pins stay where they are, wherever they were to go.
TEST(Overload, of_a_step_without_progress_is_that_of_pins_that_stay) {
  for (const StepStatus status : stalled) {
    const double held = Rising(0).measured(status).contact_overload.value;
    ASSERT_GT(held, 0.1);
    for (const double rise : {0.001, 0.003, -0.002}) {
      Rising rising(rise);
      ASSERT_EQ(rising.system.find_direction().linear.status, LinearStatus::ok);
      StepNumbers on_the_way;
      rising.system.view().report_overload(true, on_the_way);
      ASSERT_GT(std::abs(on_the_way.contact_overload.value - held), 0.1 * held) << "the motion is not felt";
      EXPECT_DOUBLE_EQ(rising.measured(status).contact_overload.value, held) << to_string(status) << rise;
    }
  }
}

TEST(Overload, is_measured_only_where_a_step_got_nowhere) {
  for (const StepStatus status : stalled) EXPECT_TRUE(Rising(0).measured(status).contact_overload.finite());
  for (const StepStatus status : {StepStatus::converged, StepStatus::linear_failed, StepStatus::non_finite,
                                  StepStatus::pin_infeasible}) {
    EXPECT_FALSE(Rising(0).measured(status).contact_overload.finite()) << to_string(status);
  }
}

TEST(Overload, an_unbounded_barrier_has_none) {
  const Scene scene = particle_over_a_plate();
  Method method = test::fixed_method("log", 1e-9);
  NewtonSystem system(scene, method);
  Prediction at_rest;
  at_rest.x_tilde = scene.x0;
  system.begin_step(scene.x0, at_rest, dt, 1.0);
  system.assemble();
  ASSERT_EQ(test::reported(system).contacts.total(), 6U);
  StepNumbers out;
  system.view().report_overload(false, out);
  EXPECT_EQ(out.contact_overload.value, 0);
}

}  // namespace
}  // namespace bb::overload_test
