// Steps whose length the run chooses: the rule, its grid, and a run that follows it.
#include "core/newton/step_size.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/base/archive/archive.hpp"
#include "core/newton/step_parts.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::step_size_test {

constexpr double dt = 0.02, d_hat = 0.05;

TEST(StepSize, halves_after_a_costly_step_and_doubles_after_a_cheap_one) {
  StepSize size({StepSizeRule::adaptive, 8, 2, 1e-3});
  ASSERT_TRUE(size.adaptive());
  size.took(0, 12, 0);  // 3/2 of what is requested is not more than that
  EXPECT_EQ(size.halvings(), 0);
  size.took(0, 13, 0);
  EXPECT_EQ(size.halvings(), 1);
  size.took(1, 8, 2e-3);  // not costly, but too far from the motion
  EXPECT_EQ(size.halvings(), 2);
  size.took(2, 40, 1);  // no shorter step is allowed
  EXPECT_EQ(size.halvings(), 2);
  size.took(2, 7, 0);
  EXPECT_EQ(size.halvings(), 2);
  size.took(2, 6, 2.6e-4);  // twice the length has four times the error
  EXPECT_EQ(size.halvings(), 2);
  size.took(2, 6, 2.5e-4);
  EXPECT_EQ(size.halvings(), 1);
  size.took(0, 1, 0);
  EXPECT_EQ(size.halvings(), 0);
}

TEST(StepSize, error_is_that_of_the_trapezoidal_rule) {
  constexpr double h = 0.1;
  const Positions x0 = Positions::Random(3, 4), v0 = Positions::Random(3, 4);
  const Vec3d g(0.5, -9.8, 2);
  Positions euler_v = v0, exact_x = x0;
  euler_v.colwise() += h * g;
  const Positions euler_x = x0 + h * euler_v;
  EXPECT_NEAR(embedded_error(x0, v0, euler_x, euler_v, h), h * h / 2 * g.norm(), 1e-15);
  exact_x += h * v0;
  exact_x.colwise() += h * h / 2 * g;
  EXPECT_NEAR(embedded_error(x0, v0, exact_x, euler_v, h), 0, 1e-15);
}

TEST(StepSize, a_longer_part_waits_for_its_place_on_the_grid) {
  StepParts parts(3);
  parts.choose(2);
  EXPECT_EQ(parts.length(dt), dt / 4);
  parts.next(true);
  parts.choose(1);  // a half does not begin at a quarter
  EXPECT_EQ(parts.length(dt), dt / 4);
  parts.next(true);
  parts.choose(1);
  EXPECT_EQ(parts.length(dt), dt / 2);
  EXPECT_TRUE(parts.ends_here());
  parts.next(true);
  ASSERT_TRUE(parts.at_start());
  parts.choose(0);
  EXPECT_EQ(parts.length(dt), dt);
}

Method adaptive_method(const std::string& integrator, const std::string& step_solver) {
  Method method = test::fixed_method("log", 20, integrator);
  method.step_solver.name = step_solver;
  method.step_size = {StepSizeRule::adaptive, 3, 3};
  return method;
}

TEST(StepSize, a_run_goes_on_from_an_archive_at_any_part_and_stays_on_its_grid) {
  const Scene scene = test::thrown_cloth(d_hat);
  StepObserver nobody;
  for (const std::string integrator : {"implicit_euler", "bdf2", "newmark"}) {
    Method method = adaptive_method(integrator, "line_search"),
           again = adaptive_method(integrator, "line_search");
    Simulation simulation(scene, method, dt, 8), other(scene, again, dt, 8);
    std::vector<double> lengths;
    double grid = 0;
    std::size_t contacts = 0;
    while (simulation.nominal_steps() < 8) {
      const int before = simulation.nominal_steps();
      Archive start;
      simulation.keep(start);
      const StepReport step = simulation.step(nobody);
      ASSERT_EQ(step.status, StepStatus::converged) << integrator << " " << step.detail;
      lengths.push_back(step.dt_s);
      contacts += step.contacts.total();
      Archive read(start.bytes());
      other.keep(read);
      other.step(nobody);
      ASSERT_EQ(other.history().x, simulation.history().x) << integrator << " part " << lengths.size();
      Archive one, two;
      simulation.keep(one);
      other.keep(two);
      EXPECT_EQ(one.bytes(), two.bytes());
      if (simulation.nominal_steps() == before) continue;
      grid += dt;
      EXPECT_EQ(simulation.time(), grid);
    }
    EXPECT_GT(contacts, 0U) << integrator;
    EXPECT_GT(lengths.size(), 8U) << integrator << ": no step was cut";
    EXPECT_LT(*std::min_element(lengths.begin(), lengths.end()),
              *std::max_element(lengths.begin(), lengths.end()));
  }
}

TEST(StepSize, a_step_that_fails_is_tried_again_with_half_its_length) {
  const Scene scene = test::thrown_cloth(d_hat);
  Method method = adaptive_method("implicit_euler", "line_search");
  method.step_solver.max_iterations = 4;
  method.step_size.halvings = 6;
  Simulation simulation(scene, method, dt, 4);
  StepObserver nobody;
  int retries = 0;
  while (simulation.nominal_steps() < 4) {
    const StepReport step = simulation.step(nobody);
    ASSERT_EQ(step.status, StepStatus::converged) << step.detail;
    retries += step.retries;
  }
  EXPECT_GT(retries, 0);
}

}  // namespace bb::step_size_test
