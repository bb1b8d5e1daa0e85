// The rules that iterations and steps are judged by, on numbers alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "core/newton/iteration.hpp"
#include "core/step_solvers/simulation.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::iteration_test {
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
  report.dx_inf_m = 1;
  report.decrement_J = 1;
  EXPECT_EQ(direction_failure(report, true), std::nullopt);

  IterationReport flat = report;
  flat.decrement_J = 0;
  EXPECT_EQ(direction_failure(flat, true), StepStatus::not_descent);
  EXPECT_EQ(direction_failure(flat, false), std::nullopt);
  flat.decrement_J = -1e-3;
  EXPECT_EQ(direction_failure(flat, true), StepStatus::not_descent);

  for (double IterationReport::*number : {&IterationReport::dx_inf_m, &IterationReport::decrement_J}) {
    IterationReport broken = report;
    broken.*number = nan;
    EXPECT_EQ(direction_failure(broken, false), StepStatus::non_finite);
  }
  IterationReport unsolved = report;
  unsolved.solve.linear.status = LinearStatus::matrix_indefinite;
  EXPECT_EQ(direction_failure(unsolved, false), StepStatus::linear_failed);
}

/// A particle that falls on a plane and bounces back.
TEST(Iteration, a_step_sums_every_count_of_its_iterations_and_keeps_the_smallest_bound_and_gap) {
  class Watch final : public StepObserver {
   public:
    void on_iteration(const IterationReport& report) override { reports.push_back(report); }
    std::vector<IterationReport> reports;
  };
  constexpr double d_hat = 0.04;
  Scene scene = test::particle_over_plane(0.2, 0.9 * d_hat, d_hat);
  scene.v0(2, 0) = -10;  // beyond the plane within the first step
  Method method = test::fixed_method("cubic", 400);
  Simulation simulation(scene, method, 0.01, 1);
  Watch watch;
  const StepReport step = simulation.step(watch);
  ASSERT_GT(watch.reports.size(), 2U);
  EXPECT_EQ(step.newton_iterations, static_cast<int>(watch.reports.size()));
  EXPECT_EQ(step.linear_solves, step.newton_iterations);
  EXPECT_EQ(step.factorizations, step.newton_iterations);
  WorkCounts sum;
  double alpha_ccd = 1, gap = d_hat;
  for (const IterationReport& report : watch.reports) {
    sum += report;
    alpha_ccd = std::min(alpha_ccd, report.alpha_ccd);
    if (report.gap_min_iterates_m.finite()) gap = std::min(gap, report.gap_min_iterates_m.value);
  }
  int counted = 0;
  for_each_field<WorkCounts>([&](const FieldText& field, auto count) {
    EXPECT_EQ(step.*count, sum.*count) << field.name;
    counted += sum.*count > 0;
  });
  EXPECT_GE(counted, 4);
  EXPECT_LT(alpha_ccd, 1);
  EXPECT_EQ(step.alpha_ccd_min, alpha_ccd);
  EXPECT_LE(step.gap_min_iterates_m.value, gap);
  EXPECT_GT(step.gap_min_iterates_m.value, 0);
}

TEST(Iteration, a_kappa_that_settles_once_starts_the_count_anew) {
  const std::vector<double> changes = {0.5, 0.02, 0.005, 0.5, 0.011};
  const std::vector<int> expected = {1, 2, 0, 1, 2};
  StepReport contact, limit;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    IterationReport report;
    report.kappa_change_rel = changes[i];
    finish(contact, report);
    EXPECT_EQ(contact.kappa_unsettled, expected[i]);
    EXPECT_EQ(contact.limit_kappa_unsettled, 0);
    report.kappa_change_rel = 0;
    report.limit_kappa_change_rel = changes[i];
    finish(limit, report);
    EXPECT_EQ(limit.limit_kappa_unsettled, expected[i]);
    EXPECT_EQ(limit.kappa_unsettled, 0);
  }
}

/// A step over a contact that ended so, after that many iterations in a row without a settled kappa.
StepReport measured(StepStatus status, int unsettled) {
  const Scene scene = test::particle_over_plane(0.2, 0.005, 0.01);
  Method method = test::fixed_method("cubic", 1);
  NewtonSystem system(scene, method);
  Prediction at_rest;
  at_rest.x_tilde = scene.x0;
  system.begin_step(scene.x0, at_rest, 0.01, 1.0);
  system.assemble();
  StepReport step;
  step.status = status;
  step.kappa_unsettled = unsettled;
  measure_end(system, step);
  EXPECT_EQ(step.contacts.total(), 1U);
  return step;
}

TEST(Iteration, a_load_is_measured_where_no_progress_was_made_and_says_why_it_is_absent_elsewhere) {
  for (const StepStatus status : {StepStatus::iteration_cap, StepStatus::step_collapse,
                                  StepStatus::line_search_failed, StepStatus::not_descent}) {
    EXPECT_TRUE(measured(status, 0).contact_overload.finite()) << to_string(status);
    EXPECT_TRUE(measured(status, 9).contact_overload.finite()) << to_string(status);  // a transient
    EXPECT_STREQ(measured(status, 10).contact_overload.status, "kappa_unsettled") << to_string(status);
    EXPECT_STREQ(measured(status, 10).limit_overload.status, "kappa_unsettled") << to_string(status);
  }
  for (const StepStatus status :
       {StepStatus::linear_failed, StepStatus::pin_infeasible, StepStatus::non_finite}) {
    EXPECT_STREQ(measured(status, 12).contact_overload.status, "not_measured") << to_string(status);
  }
  EXPECT_STREQ(measured(StepStatus::converged, 12).contact_overload.status, "converged");
}

TEST(Iteration, a_gap_of_a_step_is_that_of_a_converged_end) {
  EXPECT_EQ(measured(StepStatus::converged, 0).gap_min_m.value, 0.005);
  EXPECT_DOUBLE_EQ(measured(StepStatus::converged, 0).gap_min_rel.value, 0.5);
  const StepReport capped = measured(StepStatus::iteration_cap, 0);
  EXPECT_STREQ(capped.gap_min_m.status, "not_converged");
  EXPECT_STREQ(capped.gap_min_rel.status, "not_converged");
  EXPECT_EQ(capped.gap_min_iterates_m.value, 0.005);
}

}  // namespace
}  // namespace bb::iteration_test
