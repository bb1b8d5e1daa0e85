// From how a step ended to the word that the run ends with.
#include <gtest/gtest.h>

#include <string>

#include "experiments/run/outcome.hpp"

namespace bb::outcome_test {
namespace {

StepReport ended(StepStatus status, Number contact = Number(), Number limit = Number()) {
  StepReport step;
  step.step = 7;
  step.status = status;
  step.newton_iterations = 12;
  step.contact_overload = contact;
  step.limit_overload = limit;
  return step;
}

TEST(JudgeStep, a_converged_step_is_ok_and_says_nothing) {
  const Verdict verdict = judge_step(ended(StepStatus::converged, 5, 5));
  EXPECT_EQ(verdict.outcome, Outcome::ok);
  EXPECT_EQ(verdict.detail, "");
}

TEST(JudgeStep, no_progress_is_an_overload_above_capacity_only) {
  for (const StepStatus status : {StepStatus::iteration_cap, StepStatus::step_collapse,
                                  StepStatus::line_search_failed, StepStatus::not_descent}) {
    EXPECT_EQ(judge_step(ended(status)).outcome, Outcome::newton_stall);
    EXPECT_EQ(judge_step(ended(status, 0.99, 0.5)).outcome, Outcome::newton_stall);
    EXPECT_EQ(judge_step(ended(status, 1.01, 0.5)).outcome, Outcome::stall_overload);
    EXPECT_EQ(judge_step(ended(status, 0, 1.01)).outcome, Outcome::stall_overload);
  }
  const auto detail = [](double contact, double limit) {
    return judge_step(ended(StepStatus::step_collapse, contact, limit)).detail;
  };
  EXPECT_NE(detail(3, 2).find("step 7: load over capacity 3 at a contact"), std::string::npos)
      << detail(3, 2);
  EXPECT_NE(detail(2, 4).find("load over capacity 4 of the strain limit"), std::string::npos) << detail(2, 4);
  EXPECT_NE(detail(2, 4).find("step_collapse after 12 iterations"), std::string::npos) << detail(2, 4);
}

TEST(JudgeStep, the_probe_cap_is_blamed_for_a_collapse_that_nothing_else_explains) {
  StepReport capped = ended(StepStatus::step_collapse);
  capped.ccd_capped = 3;
  EXPECT_EQ(judge_step(capped).outcome, Outcome::ccd_cap);
  EXPECT_NE(judge_step(capped).detail.find("3 pairs"), std::string::npos);
  capped.contact_overload = 2;
  EXPECT_EQ(judge_step(capped).outcome, Outcome::stall_overload);
  capped.contact_overload = 0.5;
  capped.status = StepStatus::iteration_cap;  // it made progress
  EXPECT_EQ(judge_step(capped).outcome, Outcome::newton_stall);
}

TEST(JudgeStep, every_other_failure_has_its_own_word) {
  EXPECT_EQ(judge_step(ended(StepStatus::pin_infeasible)).outcome, Outcome::pin_infeasible);
  EXPECT_EQ(judge_step(ended(StepStatus::non_finite)).outcome, Outcome::nan);
  StepReport unsolved = ended(StepStatus::linear_failed);
  unsolved.detail =
      std::string(to_string(LinearStatus::matrix_indefinite)) + ": no positive pivot at vertex 3";
  EXPECT_EQ(judge_step(unsolved).outcome, Outcome::not_pd);
  unsolved.detail = "max_iterations";
  EXPECT_EQ(judge_step(unsolved).outcome, Outcome::linear_failure);
  EXPECT_EQ(judge_step(unsolved).detail, "step 7: linear_failed; max_iterations");
  unsolved.retries = 3;
  unsolved.dt_s = 0.125;
  EXPECT_EQ(judge_step(unsolved).detail,
            "step 7: linear_failed; max_iterations; after 3 retries, the last with 0.125 s");
}

}  // namespace
}  // namespace bb::outcome_test
