// The recorder's audit follows the run without a hole: every state has to be the end of a judged motion.
#include <gtest/gtest.h>

#include "core/step_solvers/simulation.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/calibration.hpp"
#include "experiments/run/recorder.hpp"

namespace bb::recorder_audit_test {
namespace {

constexpr const char* falling_block = R"({"schema": "barrierbench.config/1",
  "scene": {"name": "resting_block_1d"}, "formulation": {"name": "cubic", "d_hat_m": 0.01},
  "matching": {"rule": "equal_force"}, "passes": {"time": false, "audit": true}, "time": {"steps": 3}})";

/// Hands everything on, but for the motions of one step.
class Deaf final : public StepObserver {
 public:
  Deaf(Recorder& recorder, int deaf_step) : recorder_(recorder), deaf_step_(deaf_step) {}
  void on_matrix(StepSystem& system, int step, int iteration) override {
    recorder_.on_matrix(system, step, iteration);
  }
  void on_iteration(const IterationReport& report) override { recorder_.on_iteration(report); }
  void on_motion(const Positions& x0, const Positions& x1, int step) override {
    ++motions;
    if (step != deaf_step_) recorder_.on_motion(x0, x1, step);
  }
  void on_step(StepSystem& system, const StepReport& report, const Positions& x) override {
    recorder_.on_step(system, report, x);
  }
  int motions = 0;

 private:
  Recorder& recorder_;
  int deaf_step_;
};

Verdict audited(int deaf_step, RunRecord& record) {
  const RunConfig config = parse_config(falling_block, "test", ".", {});
  const Scene scene = build_scene(config);
  MatchingRecord matching;
  Method method = make_method(config, calibrate(config, scene, {}, matching));
  Simulation simulation(scene, method, config.time.dt, config.time.steps);
  Recorder recorder(config, scene, record, nullptr, nullptr);
  Deaf observer(recorder, deaf_step);
  for (int step = 0; step < config.time.steps; ++step) simulation.step(observer);
  recorder.finish();
  EXPECT_GE(observer.motions, 3);
  EXPECT_GT(record.audit.states, 1);
  return recorder.audit_verdict();
}

TEST(RecorderAudit, AStateThatNoJudgedMotionLedToIsNeverOk) {
  RunRecord whole, with_hole;
  EXPECT_EQ(audited(-1, whole).outcome, Outcome::ok);
  const Verdict verdict = audited(1, with_hole);
  EXPECT_EQ(verdict.outcome, Outcome::unproven);
  EXPECT_NE(verdict.detail.find("no judged motion, the first in step 1"), std::string::npos)
      << verdict.detail;
  EXPECT_LT(with_hole.audit.motions, whole.audit.motions);
}

}  // namespace
}  // namespace bb::recorder_audit_test
