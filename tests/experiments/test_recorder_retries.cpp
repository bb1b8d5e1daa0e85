// What a recorder keeps of a step that was tried again with half its length: attempts that failed are no part of the
// run. And of a run that a checkpoint cut in two: all of it.
#include <gtest/gtest.h>

#include <vector>

#include "core/base/archive/archive.hpp"
#include "core/step_solvers/simulation.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/recorder.hpp"
#include "tests/newton/thrown_particle.hpp"

namespace bb::recorder_retries_test {
namespace {

constexpr double dt = 0.01;

using test::thrown_particle;

RunConfig observed() {
  return parse_config(
      R"({"schema": "barrierbench.config/1", "scene": {"name": "hang"}, "formulation": "log",
          "passes": {"time": false, "audit": true, "diagnose": true}, "diagnose": {"pcg": true, "every": 1}})",
      "test", ".", {});
}

/// Hands everything on and counts the iterations that belong to the run.
class Counting final : public StepObserver {
 public:
  explicit Counting(Recorder& recorder) : recorder_(recorder) {}
  void on_matrix(StepSystem& system, int step, int iteration) override {
    recorder_.on_matrix(system, step, iteration);
  }
  void on_iteration(const IterationReport& report) override {
    ++in_step_, ++all;
    recorder_.on_iteration(report);
  }
  void on_motion(const Positions& x0, const Positions& x1, int step) override {
    recorder_.on_motion(x0, x1, step);
  }
  void on_retry(int step) override {
    in_step_ = 0, ++retries;
    recorder_.on_retry(step);
  }
  void on_step(StepSystem& system, const StepReport& report, const Positions& x) override {
    of_run += in_step_, in_step_ = 0;
    recorder_.on_step(system, report, x);
  }
  int retries = 0, all = 0, of_run = 0;

 private:
  Recorder& recorder_;
  int in_step_ = 0;
};

Method halving_method(int cap) {
  Method method = test::fixed_method("cubic", 2000);
  method.step_solver.max_iterations = cap;
  method.step_solver.retries = 6;
  return method;
}

/// A cap on iterations at which the whole first step fails.
int cap_that_fails() {
  const Scene scene = thrown_particle();
  Method method = halving_method(200);
  Simulation simulation(scene, method, dt, 1);
  StepObserver nobody;
  const StepReport step = simulation.step(nobody);
  EXPECT_EQ(step.status, StepStatus::converged);
  EXPECT_EQ(step.contacts.obstacle, 1U);
  return step.newton_iterations - 1;
}

struct Recorded {
  RunRecord record;
  int retries = 0, all = 0, of_run = 0;
  audit::AuditLedger ledger;
};

Recorded with_retries(int nominal_steps) {
  const Scene scene = thrown_particle();
  const RunConfig config = observed();
  Method method = halving_method(cap_that_fails());
  Simulation simulation(scene, method, dt, nominal_steps);
  Recorded out;
  Recorder recorder(config, scene, out.record, nullptr);
  Counting counting(recorder);
  while (simulation.nominal_steps() < nominal_steps) {
    EXPECT_EQ(simulation.step(counting).status, StepStatus::converged);
  }
  recorder.finish();
  out.retries = counting.retries, out.all = counting.all, out.of_run = counting.of_run;
  out.ledger = *recorder.ledger();
  return out;
}

TEST(RecorderRetries, ConditionNumbersAreThoseOfTheAttemptsThatLedOn) {
  const Recorded run = with_retries(6);
  ASSERT_GT(run.retries, 0);
  ASSERT_GT(run.all, run.of_run);
  int samples = 0;
  ASSERT_TRUE(run.record.summary.cond.contains("full/none"));
  for (const auto& [status, n] : run.record.summary.cond.at("full/none").statuses) samples += n;
  EXPECT_EQ(samples, run.of_run);
  EXPECT_EQ(run.record.summary.probe_pcg.n, static_cast<std::size_t>(run.of_run));
}

TEST(RecorderRetries, TheAuditFollowsTheAttemptsThatLedOnWithoutAHole) {
  const Recorded run = with_retries(6);
  ASSERT_GT(run.retries, 0);
  EXPECT_EQ(run.ledger.unjudged, 0);
  EXPECT_TRUE(run.ledger.clean());
  EXPECT_GT(run.record.audit.motions, 3);
  EXPECT_LE(run.record.audit.motions, run.of_run);
  EXPECT_EQ(run.record.audit.states, run.record.audit.motions + 1);  // the start
}

/// In the counters of work all attempts count, in the record of a step its last one.
TEST(RecorderRetries, EveryStepSaysHowOftenItWasHalved) {
  const Recorded run = with_retries(6);
  int retries = 0, iterations = 0;
  for (const StepRecord& step : run.record.steps) {
    retries += step.retries, iterations += step.newton_iterations;
    EXPECT_EQ(step.status, StepStatus::converged);
  }
  EXPECT_EQ(retries, run.retries);
  EXPECT_EQ(iterations, run.all);
  EXPECT_EQ(run.record.summary.newton_iterations, run.all);
}

/// A step that is halved three times and fails all the same.
TEST(RecorderRetries, AreCountedOneByOne) {
  const Scene scene = thrown_particle();
  const RunConfig config = observed();
  for (const int most : {0, 1, 3}) {
    Method method = halving_method(1);
    method.step_solver.retries = most;
    Simulation simulation(scene, method, dt, 1);
    RunRecord record;
    Recorder recorder(config, scene, record, nullptr);
    Counting counting(recorder);
    simulation.step(counting);
    recorder.finish();
    ASSERT_EQ(record.steps.at(0).status, StepStatus::iteration_cap);
    EXPECT_EQ(record.steps[0].retries, most);
    EXPECT_EQ(counting.retries, most);
    EXPECT_EQ(record.steps[0].newton_iterations, most + 1);
    EXPECT_TRUE(record.summary.contact_gaps.empty());  // it did not converge
  }
}

constexpr int n_steps = 10;

/// A fall, as one run and as two that an archive joins: the summary is the same number by number.
TEST(RecorderRetries, WhatWasSeenBeforeACheckpointIsInTheSummary) {
  Scene scene = thrown_particle();
  scene.x0(2, 0) = 0.016;  // in contact from its second step on
  const RunConfig config = observed();
  const auto summary = [&](int cut_after) {
    Method method = test::fixed_method("cubic", 2000), again = test::fixed_method("cubic", 2000);
    Simulation first(scene, method, dt, n_steps), second(scene, again, dt, n_steps);
    RunRecord begun, record;
    Recorder before(config, scene, begun, nullptr), after(config, scene, record, nullptr);
    for (int i = 0; i < cut_after; ++i) first.step(before);
    Archive archive;
    before.keep(archive);
    first.keep(archive);
    Archive read(archive.bytes());
    after.keep(read);
    second.keep(read);
    EXPECT_TRUE(read.at_end());
    for (int i = cut_after; i < n_steps; ++i) second.step(after);
    after.finish();
    return record.summary;
  };
  const Summary whole = summary(0);
  ASSERT_EQ(whole.contact_gaps.size(), 1U);
  const auto& [pair, gaps] = *whole.contact_gaps.begin();
  ASSERT_LT(gaps.gap_rel_p05, 0.99 * gaps.gap_rel_p95);  // else a part would have the same
  ASSERT_LT(gaps.time_share, 1);
  for (const int cut_after : {1, 2, 3, 6}) {
    const Summary parts = summary(cut_after);
    ASSERT_TRUE(parts.contact_gaps.contains(pair)) << cut_after;
    const PairGaps& other = parts.contact_gaps.at(pair);
    EXPECT_EQ(other.load_N, gaps.load_N) << cut_after;
    EXPECT_EQ(other.load_share, gaps.load_share);
    EXPECT_EQ(other.time_share, gaps.time_share) << cut_after;
    EXPECT_EQ(other.gap_rel_p05, gaps.gap_rel_p05) << cut_after;
    EXPECT_EQ(other.gap_rel_median, gaps.gap_rel_median) << cut_after;
    EXPECT_EQ(other.gap_rel_p95, gaps.gap_rel_p95) << cut_after;
    EXPECT_EQ(parts.newton_iterations, whole.newton_iterations);
    EXPECT_EQ(parts.linear_per_solve.n, whole.linear_per_solve.n);
    EXPECT_EQ(parts.first_contact.size(), whole.first_contact.size());
    EXPECT_EQ(parts.cond.at("full/none").statuses, whole.cond.at("full/none").statuses);
  }
}

}  // namespace
}  // namespace bb::recorder_retries_test
