// Single steps of a run, tried again: they begin from all that the run had, what policies remember included.
#include "experiments/run/step_study.hpp"

#include <algorithm>

#include "core/base/record/provenance.hpp"
#include "core/step_solvers/simulation.hpp"
#include "experiments/run/plan.hpp"
#include "tests/experiments/calibrated.hpp"

namespace bb::step_study_test {
namespace {

using namespace test;

struct RunSteps {
  std::vector<std::string> hash;     // of the end of each step
  std::vector<int> doublings = {0};  // before each step, and at the end
  std::vector<std::size_t> contacts;
};

RunSteps run_steps(const RunConfig& config) {
  const Scene scene = build_scene(config);
  MatchingRecord matching;
  Method method = make_method(config, calibrate(config, scene, {}, matching));
  Simulation simulation(scene, method, plan_of(config, scene), config.time.dt, config.time.steps);
  StepObserver nobody;
  RunSteps out;
  for (int step = 0; step < config.time.steps; ++step) {
    const StepReport report = simulation.step(nobody);
    EXPECT_EQ(report.status, StepStatus::converged) << step;
    out.hash.push_back(state_hash(simulation.history().x));
    out.doublings.push_back(method.stiffness->state().doublings);
    out.contacts.push_back(report.contacts.total());
  }
  return out;
}

std::string trial_hash(const std::vector<StepTrial>& trials, int step, const std::string& hessian) {
  for (const StepTrial& trial : trials) {
    if (trial.step == step && trial.hessian == hessian) return trial.state_hash;
  }
  return "no trial";
}

/// kappa doubles at the ends of steps, of pairs that it saw at the end of the step before too.
TEST(StepStudy, ATrialWithTheRunsOwnChoiceIsTheRunsStep) {
  const RunConfig config =
      parsed(falling, {"/formulation=ipc2020", "/matching/rule=as_given", "/formulation/d_hat_m=0.01",
                       "/formulation/stiffness_policy/doubling_gap_m=0.004"});
  const RunSteps run = run_steps(config);
  int doubling = -1;  // a step after a doubling, at whose end kappa doubles again
  for (int step = 1; step < config.time.steps && doubling < 0; ++step) {
    const auto i = static_cast<std::size_t>(step);
    if (run.doublings[i] > 0 && run.doublings[i + 1] > run.doublings[i]) doubling = step;
  }
  ASSERT_GT(doubling, 0);
  ASSERT_LT(doubling + 1, config.time.steps);
  ASSERT_GT(run.contacts[static_cast<std::size_t>(doubling)], 0U);
  const std::vector<StepTrial> trials = study_steps(config, {doubling, doubling + 1}, {});
  for (const int step : {doubling, doubling + 1}) {
    EXPECT_EQ(trial_hash(trials, step, "blend"), run.hash[static_cast<std::size_t>(step)]) << step;
  }
}

/// The second step of BDF2 has another weight than the first, and of what a step keeps only the last one counts.
TEST(StepStudy, ATrialBeginsFromTheHistoryOfItsStep) {
  const RunConfig config = parsed(two_masses, {R"(/integrator/name="bdf2")", "/matching/load_N=5"});
  const RunSteps run = run_steps(config);
  const std::vector<StepTrial> trials = study_steps(config, {0, 1, 9}, {});
  std::vector<std::string> seen;
  for (const int step : {0, 1, 9}) {
    EXPECT_EQ(trial_hash(trials, step, "blend"), run.hash[static_cast<std::size_t>(step)]) << step;
    seen.push_back(trial_hash(trials, step, "blend"));
  }
  EXPECT_NE(seen[0], seen[1]);
  EXPECT_NE(seen[1], seen[2]);
}

}  // namespace
}  // namespace bb::step_study_test
