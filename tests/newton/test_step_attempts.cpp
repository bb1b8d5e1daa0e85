// What a report has of a step that was tried again: the work of all attempts, everything else of the last one, and how
// much of the work was before it.
#include <gtest/gtest.h>

#include <vector>

#include "core/base/record/step_record.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::step_attempts_test {
namespace {

/// An attempt with numbers of its own in every counter.
StepReport attempt(int seed, StepStatus status) {
  StepReport out;
  out.status = status;
  out.newton_iterations = 3 + seed;
  int next = 100 * seed;
  for_each_field<WorkCounts>([&](const FieldText&, auto count) { out.*count = ++next; });
  out.dt_s = 0.01 / (1 << seed);
  out.gap_min_m = 0.1 * seed;
  return out;
}

TEST(StepAttempts, AddUpTheWorkOfAllAndKeepTheRestOfTheLast) {
  for (const int n : {1, 2, 4}) {
    StepReport step = attempt(1, n == 1 ? StepStatus::converged : StepStatus::iteration_cap);
    WorkCounts work = step;
    int iterations = step.newton_iterations, before = 0;
    long long capped_before = 0;
    for (int i = 2; i <= n; ++i) {
      StepReport shorter = attempt(i, i == n ? StepStatus::converged : StepStatus::step_collapse);
      before = iterations, capped_before = work.ccd_capped;
      iterations += shorter.newton_iterations;
      work += shorter;
      shorter.add_attempt(step);
      step = shorter;
    }
    EXPECT_EQ(step.retries, n - 1);
    EXPECT_EQ(step.newton_iterations, iterations);
    EXPECT_EQ(step.iterations_before, before);
    EXPECT_EQ(step.ccd_capped_before, capped_before);
    for_each_field<WorkCounts>(
        [&](const FieldText& field, auto count) { EXPECT_EQ(step.*count, work.*count) << field.name << n; });
    EXPECT_EQ(step.status, StepStatus::converged);
    EXPECT_EQ(step.dt_s, 0.01 / (1 << n));
    EXPECT_EQ(step.gap_min_m.value, 0.1 * n);
  }
}

/// An attempt whose motion was not proven is followed by one as long.
TEST(StepAttempts, ThatAreNotProvenAreNoRetries) {
  StepReport failed = attempt(1, StepStatus::iteration_cap), unproven = attempt(2, StepStatus::converged),
             last = attempt(3, StepStatus::converged);
  failed.audited_queries = 0, unproven.audited_queries = 5, last.audited_queries = 0;
  const int iterations = failed.newton_iterations + unproven.newton_iterations + last.newton_iterations;
  unproven.add_attempt(failed);
  last.add_unproven(unproven);
  EXPECT_EQ(last.retries, 1);
  EXPECT_EQ(last.redone_audited, 1);
  EXPECT_EQ(last.audited_queries, 5);
  EXPECT_EQ(last.newton_iterations, iterations);
  StepReport shorter = attempt(4, StepStatus::converged);
  shorter.add_attempt(last);
  EXPECT_EQ(shorter.retries, 2);
  EXPECT_EQ(shorter.redone_audited, 1);
  EXPECT_EQ(shorter.audited_queries, 5);
}

/// The iterations of the last attempt, as an observer counts them.
TEST(StepAttempts, SayHowManyIterationsWereBeforeTheLast) {
  class Watch final : public StepObserver {
   public:
    void on_iteration(const IterationReport& report) override { last = report.iteration + 1, ++all; }
    int last = 0, all = 0;
  };
  Scene scene = test::particle_over_plane(0.2, 0.012, 0.01);
  scene.v0(2, 0) = -0.3;
  for (const int retries : {0, 1, 3}) {
    Method method = test::fixed_method("cubic", 2000);
    method.step_solver.max_iterations = 1;  // no attempt converges
    method.step_solver.retries = retries;
    Simulation simulation(scene, method, 0.01, 1);
    Watch watch;
    const StepReport step = simulation.step(watch);
    ASSERT_EQ(step.status, StepStatus::iteration_cap);
    EXPECT_EQ(step.retries, retries);
    EXPECT_EQ(step.newton_iterations, watch.all);
    EXPECT_EQ(step.newton_iterations - step.iterations_before, watch.last);
    EXPECT_EQ(step.iterations_before, retries);
  }
}

}  // namespace
}  // namespace bb::step_attempts_test
