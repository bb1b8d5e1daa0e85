// The rules that iterations and steps are judged by, on numbers alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "core/newton/iteration.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb {
namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

void finish(StepReport& step, IterationReport report) {
  const Scene scene = test::particle_over_plane(0.2, 1, 0.01);
  Method method = test::fixed_method("log", 1);
  NewtonSystem system(scene, method);
  StepObserver nobody;
  finish_iteration(system, step, report, nobody);
}

TEST(Iteration, a_change_of_64_roundings_of_the_terms_is_noise_in_either_direction) {
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_TRUE(within_rounding({sign * 60 * eps * 5, 5}));
    EXPECT_FALSE(within_rounding({sign * 70 * eps * 5, 5}));
  }
  EXPECT_FALSE(within_rounding({nan, 5}));
}

TEST(Iteration, what_does_not_hold_in_a_row_starts_the_count_anew) {
  int count = 0, longest = 0;
  for (const bool holds : {true, true, true, false, true, true}) {
    count = in_a_row(count, holds);
    longest = std::max(longest, count);
  }
  EXPECT_EQ(longest, 3);
  EXPECT_EQ(count, 2);
}

TEST(Iteration, a_direction_fails_when_it_is_unsolved_not_finite_or_uphill) {
  IterationReport report;
  report.dx_inf = 1;
  report.decrement = 2;
  EXPECT_EQ(direction_failure(report, true), std::nullopt);

  IterationReport flat = report;
  flat.decrement = 0;
  EXPECT_EQ(direction_failure(flat, true), StepStatus::not_descent);
  EXPECT_EQ(direction_failure(flat, false), std::nullopt);
  flat.decrement = -1e-3;
  EXPECT_EQ(direction_failure(flat, true), StepStatus::not_descent);

  for (double IterationReport::*number : {&IterationReport::dx_inf, &IterationReport::decrement}) {
    IterationReport broken = report;
    broken.*number = nan;
    EXPECT_EQ(direction_failure(broken, false), StepStatus::non_finite);
  }
  IterationReport unsolved = report;
  unsolved.linear.status = LinearStatus::matrix_indefinite;
  EXPECT_EQ(direction_failure(unsolved, false), StepStatus::linear_failed);
}

TEST(Iteration, a_step_sums_its_iterations_and_keeps_the_smallest_steps) {
  IterationReport one;
  one.alpha = 0.5;
  one.alpha_ccd = 0.25;
  one.line_search_trials = 2;
  one.accepted_by_rounding = true;
  one.linear.iterations = 3;
  one.linear.factorized = one.linear.analyzed = true;
  one.bound = {0.25, ContactKind::obstacle, {-1, -1, -1, -1}, 5, 7, 11, 13};
  one.kappa_change = 0.5;
  IterationReport two = one;
  two.alpha = two.alpha_ccd = 1;
  two.kappa_change = 0.25;
  StepReport step;
  finish(step, one);
  finish(step, two);
  EXPECT_EQ(step.iterations, 2);
  EXPECT_EQ(step.alpha_min, 0.5);
  EXPECT_EQ(step.alpha_ccd_min, 0.25);
  EXPECT_EQ(step.line_search_trials, 4);
  EXPECT_EQ(step.accepted_by_rounding, 2);
  EXPECT_EQ(step.linear_iterations, 6);
  EXPECT_EQ(step.factorizations, 2);
  EXPECT_EQ(step.analyses, 2);
  EXPECT_EQ(step.ccd_queries, 10);
  EXPECT_EQ(step.ccd_probes, 14);
  EXPECT_EQ(step.ccd_capped, 22);
  EXPECT_EQ(step.ccd_zero, 26);
  EXPECT_EQ(step.kappa_change, 0.25);
}

TEST(Iteration, a_kappa_that_settles_once_starts_the_count_anew) {
  const std::vector<double> changes = {0.5, 0.02, 0.005, 0.5, 0.011};
  const std::vector<int> expected = {1, 2, 0, 1, 2};
  StepReport contact, limit;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    IterationReport report;
    report.kappa_change = changes[i];
    finish(contact, report);
    EXPECT_EQ(contact.kappa_unsettled, expected[i]);
    EXPECT_EQ(contact.limit_kappa_unsettled, 0);
    report.kappa_change = 0;
    report.limit_kappa_change = changes[i];
    finish(limit, report);
    EXPECT_EQ(limit.limit_kappa_unsettled, expected[i]);
    EXPECT_EQ(limit.kappa_unsettled, 0);
  }
}

/// Stalled steps measure their load, others do not.
TEST(Iteration, every_step_without_progress_measures_its_load) {
  const auto measured = [](StepStatus status) {
    const Scene scene = test::particle_over_plane(0.2, 0.005, 0.01);
    Method method = test::fixed_method("cubic", 1);
    NewtonSystem system(scene, method);
    Prediction at_rest;
    at_rest.x_tilde = scene.x0;
    system.begin_step(scene.x0, at_rest, 0.01, 1.0);
    system.assemble();
    StepReport step;
    step.status = status;
    measure_end(system, step);
    return step.overload.has_value();
  };
  for (const StepStatus status : {StepStatus::iteration_cap, StepStatus::step_collapse,
                                  StepStatus::line_search_failed, StepStatus::not_descent}) {
    EXPECT_TRUE(measured(status)) << to_string(status);
  }
  for (const StepStatus status : {StepStatus::converged, StepStatus::linear_failed,
                                  StepStatus::pin_infeasible, StepStatus::non_finite}) {
    EXPECT_FALSE(measured(status)) << to_string(status);
  }
}

}  // namespace
}  // namespace bb
