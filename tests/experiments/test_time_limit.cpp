// A time limit that passes before the first step of a run: in the calibration run, while its forces are read, while a policy is
// followed to its first contact. What waits for the limit is the progress line, so no machine is too fast or too slow.
#include <fmt/format.h>

#include <chrono>
#include <thread>

#include "core/base/record/phase_times.hpp"
#include "core/base/record/writer.hpp"
#include "experiments/run/runner.hpp"
#include "tests/experiments/calibrated.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::time_limit_test {
namespace {

using namespace test;

constexpr double limit_s = 0.5;

struct Stopped {
  RunRecord record;
  int steps_shown = 0;       // of calibration run and policy, until the run was over
  double after_limit_s = 0;  // how long the run went on
};

/// A run in which the step shown as number `at` (from 1) before its passes ends after the limit. d_hat_m: its own, so that no other
/// test has left its calibration run behind.
Stopped stopped_at(int at, double d_hat_m, const std::vector<std::string>& overrides = {}) {
  std::vector<std::string> all = {fmt::format("/formulation/d_hat_m={}", d_hat_m)};
  all.insert(all.end(), overrides.begin(), overrides.end());
  Stopped out;
  RunOptions options;
  const test::TemporaryFolder folder;
  options.folder = folder;
  options.time_limit_s = limit_s;
  const double begin = now_s();
  options.progress = [&](const Progress& progress) {
    if (std::string_view(progress.pass) != "calibration" || ++out.steps_shown != at) return;
    while (now_s() < begin + 1.2 * limit_s) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  };
  run_config(parsed(falling, all), options);
  out.after_limit_s = now_s() - begin - 1.2 * limit_s;
  out.record = read_run(options.folder / "run.json").value();
  return out;
}

void expect_a_record_without_steps(const Stopped& run, const std::string& where) {
  EXPECT_EQ(run.record.status.outcome, Outcome::timeout);
  EXPECT_EQ(run.record.status.detail,
            fmt::format("calibration run: the time limit of {:g} s was reached {}; there was no first step",
                        limit_s, where));
  EXPECT_FALSE(run.record.status.valid);
  EXPECT_TRUE(run.record.steps.empty());
  EXPECT_TRUE(run.record.artifacts.empty());
  EXPECT_LT(run.after_limit_s, 2);
}

TEST(TimeLimit, EndsTheCalibrationRunBeforeItsNextStep) {
  const Stopped run = stopped_at(2, 0.0101);
  EXPECT_EQ(run.steps_shown, 2);
  expect_a_record_without_steps(run, "before its step 2 of 20");
}

TEST(TimeLimit, EndsTheReadingOfItsForces) {
  const Stopped run = stopped_at(20, 0.0102);
  EXPECT_EQ(run.steps_shown, 20);
  expect_a_record_without_steps(run, "while the forces of its step 0 of 20 were read");
}

TEST(TimeLimit, EndsTheWayOfAPolicyToItsFirstContact) {
  const Stopped run = stopped_at(21, 0.0103, {R"(/formulation/stiffness_policy={"name": "ipc_adaptive"})"});
  EXPECT_EQ(run.steps_shown, 21);
  expect_a_record_without_steps(run, "before step 1 of 20 to the first contact of the policy");
}

}  // namespace
}  // namespace bb::time_limit_test
