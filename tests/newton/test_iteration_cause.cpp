// One cause an iteration: what shortened it decides before what changed its direction.
#include "core/newton/iteration_cause.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>

namespace bb::iteration_cause_test {
namespace {

/// An iteration that takes its whole direction.
IterationReport whole() {
  IterationReport out;
  LinearReport linear;
  linear.status = LinearStatus::ok;
  out.solve.add_attempt(linear);
  out.alpha = 1;
  return out;
}

TEST(IterationCause, TheWholeDirectionIsFullOrOfARegularisedMatrix) {
  IterationReport report = whole();
  EXPECT_EQ(cause_of(report, 0.8), IterationCause::full);
  EXPECT_FALSE(is_regularised(report));
  report.solve.t = 0.125;
  EXPECT_EQ(cause_of(report, 0.8), IterationCause::indefinite);
  report.solve.t = 0;
  report.solve.add_attempt(report.solve.linear);
  EXPECT_EQ(cause_of(report, 0.8), IterationCause::indefinite);
  EXPECT_TRUE(is_regularised(report));
}

TEST(IterationCause, TheSmallerBoundHoldsTheStepWhateverItsMatrixWas) {
  IterationReport report = whole();
  report.solve.t = 1;
  report.alpha_ccd = 0.5, report.alpha_strain = 0.6, report.alpha = 0.8 * 0.5;
  EXPECT_EQ(cause_of(report, 0.8), IterationCause::contact);
  report.alpha_strain = 0.25, report.alpha = 0.8 * 0.25;
  EXPECT_EQ(cause_of(report, 0.8), IterationCause::limit);
  report.alpha_ccd = 0.25;
  EXPECT_EQ(cause_of(report, 0.8), IterationCause::contact) << "of two that are the same";
}

TEST(IterationCause, LessThanTheBoundAllowsIsArmijo) {
  IterationReport report = whole();
  report.alpha = 0.5;
  EXPECT_EQ(cause_of(report, 0.8), IterationCause::armijo);
  report.alpha_ccd = 0.5, report.alpha = 0.8 * 0.5 / 2;
  EXPECT_EQ(cause_of(report, 0.8), IterationCause::armijo);
  EXPECT_EQ(cause_of(report, 0.4), IterationCause::contact) << "a step solver that takes less of a bound";
  report.alpha = 0;
  EXPECT_EQ(cause_of(report, 0.8), IterationCause::armijo);
}

TEST(IterationCause, ACorrectionOfACurvedGapIsContactAndAnEscapeIsIndefinite) {
  IterationReport report = whole();
  report.detours = 1;
  EXPECT_EQ(cause_of(report, 0.8), IterationCause::contact);
  report.escapes = 1, report.alpha = 0.25;
  EXPECT_EQ(cause_of(report, 0.8), IterationCause::indefinite);
}

TEST(IterationCause, RoundingAndNoDirectionComeFirst) {
  IterationReport report = whole();
  report.rounding_accepts = 1, report.alpha = 0.5;
  EXPECT_EQ(cause_of(report, 0.8), IterationCause::noise);
  report.dx_inf_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(cause_of(report, 0.8), IterationCause::failed);
  report = whole();
  report.solve.linear.status = LinearStatus::matrix_indefinite;
  EXPECT_EQ(cause_of(report, 0.8), IterationCause::failed);
}

TEST(IterationCause, EveryCauseHasAWordOfItsOwn) {
  std::set<std::string> words;
  for (const IterationCause cause : all_iteration_causes) words.emplace(to_string(cause));
  EXPECT_EQ(words.size(), std::size(all_iteration_causes));
}

}  // namespace
}  // namespace bb::iteration_cause_test
