// The dynamic stiffness as a potential: energy, gradient and matrix of the whole system belong together while
// everything moves that moves within a step.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/newton/small_scenes.hpp"
#include "tests/terms/all_terms.hpp"

namespace bb::potential_test {
namespace {

PolicyConfig dynamic_policy(const char* mass_term, bool included) {
  PolicyConfig policy;
  policy.name = "elasticity_inclusive";
  policy.parameters.emplace("mass_term", std::string(mass_term));
  policy.parameters.emplace("refresh", std::string(included ? "per_step" : "per_iteration"));
  policy.parameters.emplace("derivative", std::string(included ? "included" : "dropped"));
  return policy;
}

Method potential_method(const char* mass_term) {
  Method method = test::fixed_method("cubic", 1);
  method.stiffness = make_policy(dynamic_policy(mass_term, true));
  method.limit_stiffness = make_policy(dynamic_policy(mass_term, true), PolicyUse::limit);
  return method;
}

/// A step from x0, with its iterate moved to x.
struct AtIterate {
  Scene scene = test::scene_with_everything();
  Method method;
  NewtonSystem system;
  Positions x;

  explicit AtIterate(const char* mass_term) : method(potential_method(mass_term)), system(scene, method) {
    begin(scene.x0);
    x = test::disturbed(scene, 0.004);
    move_to(x);
  }
  void begin(const Positions& x_n) {
    Prediction prediction;
    prediction.x_tilde = x_n;
    prediction.x_tilde.row(2).array() -= 0.01;
    system.begin_step(x_n, prediction, 0.05, 1.0);
    system.assemble();
  }
  void move_to(const Positions& to) {
    ASSERT_TRUE(test::try_state(system, to).has_value());
    system.accept();
    system.assemble();
  }
  const ContactState& rows() { return test::rows_of(system); }
};

/// Largest relative difference of the mass parts of rows that both tables have.
double largest_difference(const ContactTable& a, const ContactTable& b) {
  double out = 0;
  for (std::size_t r = 0; r < a.size(); ++r) {
    for (std::size_t s = 0; s < b.size(); ++s) {
      if (a.pair[r] != b.pair[s]) continue;
      out = std::max(out, relative_change(a.parts[r].per_gap_sq, b.parts[s].per_gap_sq));
    }
  }
  return out;
}

/// Contact rows, mollified rows and the limit, all of them active; closest points and with them the weights of
/// the rows have moved since the step began, and move in the differences too.
TEST(Potential, the_gradient_is_that_of_E_with_everything_moving_that_moves) {
  for (const char* mass_term : {"paper", "scaled"}) {
    AtIterate at(mass_term);
    const Positions gradient = at.system.view().gradient();
    ASSERT_GT(at.rows().rows.size(), 10U);
    ASSERT_GT(at.rows().mollified.size(), 3U);
    ASSERT_GT(test::reported(at.system).limit_load_max_N_per_m.value, 0);
    ASSERT_GT(at.system.view().energy(TermGroup::contact), 0);
    ASSERT_GT(at.system.view().energy(TermGroup::limit), 0);

    const double h = 1e-6;
    Positions numeric(3, at.x.cols());
    for (Eigen::Index i = 0; i < at.x.size(); ++i) {
      double change[2];
      for (const int side : {0, 1}) {
        Positions to = at.x;
        to.data()[i] += side == 0 ? -h : h;
        change[side] = test::try_state(at.system, to).value().change;
      }
      numeric.data()[i] = (change[1] - change[0]) / (2 * h);
    }
    EXPECT_LT((numeric - gradient).norm(), 1e-6 * gradient.norm()) << mass_term;

    // the weights did move: evaluated at x, the policy gives other masses than it gave at the step's start
    const ContactTable frozen = at.rows().rows;
    at.begin(at.x);
    EXPECT_GT(largest_difference(frozen, at.rows().rows), 1e-3);
  }
}

/// Dropped, the same force at every gap comes with a curvature d/d_hat times as large.
TEST(Potential, the_matrix_has_the_curvature_that_the_force_shows_where_the_derivative_is_included) {
  constexpr double mass = 0.2, d_hat = 0.01, dt = 0.1, gap = 0.3 * d_hat;
  const Scene scene = test::particle_over_plane(mass, gap, d_hat);
  for (const bool included : {true, false}) {
    double curvature = 0, shown = 0;
    for (const double z : {gap * (1 - 1e-5), gap * (1 + 1e-5), gap}) {
      Method method = test::fixed_method("cubic", 1);
      method.stiffness = make_policy(dynamic_policy("paper", included));
      NewtonSystem system(scene, method);
      Prediction prediction;
      prediction.x_tilde = scene.x0;
      const Positions x = test::one_point(0, 0, z);
      system.begin_step(x, prediction, dt, 1.0);
      system.assemble();
      const double force = system.view().gradient()(2, 0);
      if (z != gap) shown += (z > gap ? force : -force) / (2e-5 * gap);
      curvature = system.diagnosis().clamped().lower.coeff(2, 2);
    }
    const double exact = mass / (dt * dt) + 4 * mass / (gap * gap) * (d_hat - gap) / gap;  // E''
    EXPECT_NEAR(shown, exact, 1e-6 * exact);  // the force is the same function of the gap
    EXPECT_EQ(std::abs(curvature / exact - 1) < 1e-12, included) << curvature << " " << exact;
  }
}

/// A gap at which kappa refreshed per iteration cycles for ever (test_kappa_cycle.cpp).
TEST(Potential, a_step_ends_where_its_force_balances_below_half_of_d_hat) {
  constexpr double mass = 0.2, d_hat = 0.01, dt = 0.1, gap = 0.3 * d_hat;
  const auto force = [](double d) { return 2 * mass * (d_hat - d) * (d_hat - d) / (d_hat * d * d); };
  Scene scene = test::particle_over_plane(mass, 1.2 * gap, d_hat);
  scene.gravity = Vec3d(0, 0, -force(gap) / mass);
  Method method = test::fixed_method("cubic", 1);
  method.stiffness = make_policy(dynamic_policy("paper", true));
  method.step_solver.tol_velocity = 1e-11;
  method.step_solver.max_iterations = 30;
  Simulation simulation(scene, method, dt, 1);
  StepObserver none;
  const StepReport step = simulation.step(none);
  EXPECT_EQ(step.status, StepStatus::converged) << step.detail;
  EXPECT_EQ(step.contacts.obstacle, 1U);
  const double d = simulation.history().x(2, 0), inertia = mass * (1.2 * gap - d) / (dt * dt);
  EXPECT_NEAR(force(d) + inertia, force(gap), 1e-8 * force(gap));
  EXPECT_LT(d, 0.35 * d_hat);
  EXPECT_NEAR(step.contact_load_max_N.value, force(d), 1e-10 * force(d));
  EXPECT_NEAR(step.kappa_max_N_per_m.value, mass / (d * d), 1e-10 * mass / (d * d));
}

/// A particle that meets the plane within the step has kappa = m/d^2 of its gap, not of d_hat.
TEST(Potential, a_contact_that_a_line_search_meets_has_the_kappa_of_its_gap) {
  constexpr double mass = 0.2, d_hat = 0.01;
  Scene scene = test::particle_over_plane(mass, 1.1 * d_hat, d_hat);
  scene.v0.col(0) = Vec3d(0, 0, -0.06);
  scene.gravity.setZero();
  Method method = test::fixed_method("cubic", 1);
  method.stiffness = make_policy(dynamic_policy("paper", true));
  Simulation simulation(scene, method, 0.1, 1);
  StepObserver none;
  ASSERT_EQ(simulation.step(none).contacts.obstacle, 1U);
  const double d = simulation.history().x(2, 0), kappa = mass / (d * d);
  ASSERT_LT(d, 0.97 * d_hat);
  EXPECT_NEAR(test::rows_of(simulation.system()).rows.kappa.at(0), kappa, 1e-9 * kappa);
}

}  // namespace
}  // namespace bb::potential_test
