// A particle that comes to rest on a plane: the gap has to be the one at which the barrier
// carries the weight.
#include <gtest/gtest.h>

#include <cmath>

#include "barriers/matching.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::contact_equilibrium_test {
namespace {

constexpr double mass = 0.2, d_hat = 0.01, weight = 2.0;

// Gap at the end; implicit Euler damps the bounce away.
double resting_gap(const Scene& scene, Method& method, int steps, double dt, ContactCounts& contacts) {
  method.step_solver.tol_velocity = 1e-11;
  Simulation simulation(scene, method, dt, steps);
  StepObserver observer;
  StepReport report;
  for (int i = 0; i < steps; ++i) {
    report = simulation.step(observer);
    EXPECT_EQ(report.status, StepStatus::converged) << report.detail;
    if (report.status != StepStatus::converged) break;
  }
  contacts = report.contacts;
  return report.gap_min_m.value;
}

TEST(ContactEquilibrium, every_shape_and_argument_rests_where_its_force_is_the_weight) {
  int tested = 0;
  for (const Shape& shape : all_shapes()) {
    for (const Argument argument : {Argument::gap, Argument::squared_gap}) {
      const BarrierFunction barrier{shape, argument};
      const double kappa = match_equal_force(barrier, d_hat, weight, 0.6);
      // Close to rest: on the squared argument the force of the polynomials falls towards contact, and an
      // impact would crush them.
      Scene scene = test::particle_over_plane(mass, 0.62 * d_hat, d_hat);
      Method method = test::fixed_method(shape.name, kappa);
      method.contact = barrier;

      ContactCounts contacts;
      const double gap = resting_gap(scene, method, 4000, 0.01, contacts);

      const auto expected = equilibrium(barrier, kappa, d_hat, weight);
      ASSERT_TRUE(expected.d.has_value());
      EXPECT_EQ(contacts.obstacle, 1U);
      EXPECT_NEAR(gap / *expected.d, 1, 1e-7) << shape.name << " " << to_string(argument);
      ++tested;
    }
  }
  EXPECT_GE(tested, 10);
}

TEST(ContactEquilibrium, dynamic_stiffness_rests_at_the_closed_form) {
  // kappa = m/d^2 with the cubic: d*/d_hat = 1/(1 + s), s = sqrt(f d_hat/(2 m)).
  for (const Refresh refresh : {Refresh::per_iteration, Refresh::per_step}) {
    Scene scene = test::particle_over_plane(mass, 0.9 * d_hat, d_hat);
    Method method = test::fixed_method("cubic", 1);
    PolicyConfig policy;
    policy.name = "elasticity_inclusive";
    policy.parameters.emplace("refresh", std::string(to_string(refresh)));
    method.stiffness = make_policy(policy);

    ContactCounts contacts;
    const double gap = resting_gap(scene, method, 400, 0.01, contacts);

    const double s = std::sqrt(weight * d_hat / (2 * mass));
    EXPECT_EQ(contacts.obstacle, 1U);
    EXPECT_NEAR(gap, d_hat / (1 + s), 1e-7 * d_hat);
  }
}

TEST(ContactEquilibrium, every_integrator_with_inertia_conserves_free_fall_under_the_weight_that_it_has_act) {
  for (const IntegratorEntry& entry : integrators()) {
    if (make_integrator(entry.name)->quasi_static()) continue;
    Scene scene = test::particle_over_plane(mass, 100, d_hat);
    Method method = test::fixed_method("log", 1, entry.name);
    Simulation simulation(scene, method, 0.01, 20);
    StepObserver observer;
    for (int i = 0; i < 20; ++i)
      ASSERT_EQ(simulation.step(observer).status, StepStatus::converged) << entry.name;
    const double factor = method.integrator->weight_factor();
    EXPECT_NEAR(simulation.history().v(2, 0), factor * -10 * 0.2, 1e-10) << entry.name;
  }
}

TEST(ContactEquilibrium, adaptive_stiffness_starts_at_the_first_contact_and_is_recorded) {
  Scene scene = test::particle_over_plane(mass, 0.9 * d_hat, d_hat);
  Method method = test::fixed_method("log", 1);
  PolicyConfig policy;
  policy.name = "ipc_adaptive";
  method.stiffness = make_policy(policy);
  ContactCounts contacts;
  const double gap = resting_gap(scene, method, 200, 0.01, contacts);
  const StiffnessPolicy::State state = method.stiffness->state();
  ASSERT_GT(state.kappa_start, 0);
  EXPECT_EQ(contacts.obstacle, 1U);
  const auto expected = equilibrium(method.contact, state.kappa, d_hat, weight);
  EXPECT_NEAR(gap / expected.d.value(), 1, 1e-7);
}

}  // namespace
}  // namespace bb::contact_equilibrium_test
