// States of steps: what is kept is read again, and the states of results/steps are those of this program.
#include "experiments/run/step_state.hpp"

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/record/provenance.hpp"
#include "experiments/run/step_corpus.hpp"
#include "tests/experiments/calibrated.hpp"
#include "tests/folders.hpp"

namespace bb::step_state_test {
namespace {

using namespace test;
namespace fs = std::filesystem;

const fs::path source = BB_SOURCE_DIR;

/// The hash after `steps` steps of a run.
std::string hash_after(const RunConfig& config, int steps) {
  const Scene scene = build_scene(config);
  MatchingRecord matching;
  Method method = make_method(config, calibrate(config, scene, {}, matching));
  Simulation simulation(scene, method, plan_of(config, scene), config.time.dt, config.time.steps);
  StepObserver nobody;
  for (int step = 0; step < steps; ++step) simulation.step(nobody);
  return state_hash(simulation.history().x);
}

TEST(StepState, AKeptStateHasTheCalibrationAndGivesTheStepOfItsRun) {
  const RunConfig config = parsed(falling, {"/time/steps=16"});
  const TemporaryFolder folder;
  const fs::path place = folder;
  keep_step_state(config, 12, place / "cloth", {});
  ASSERT_EQ(step_states_in(place), std::vector<std::string>{"cloth"});
  const StepState state = read_step_state(place, "cloth");
  EXPECT_EQ(state.start.step, 12);
  EXPECT_TRUE(state.calibration.kappa.has_value()) << "the calibration of equal_force is kept";
  const CorpusState taken = take_state(state, {}, {}, {});
  EXPECT_EQ(taken.reference, StepStatus::converged);
  EXPECT_GT(taken.contacts, 0U);
  int judged = 0;
  for (const CorpusTrial& trial : taken.trials) {
    int sum = 0;
    for (const int count : trial.causes) sum += count;
    EXPECT_EQ(sum, trial.iterations) << trial.step_solver << trial.hessian;
    if (trial.hessian != "blend" || trial.exact_friction) continue;
    EXPECT_EQ(trial.state_hash, hash_after(config, 13));
    EXPECT_EQ(trial.minimum, "A");
    EXPECT_GT(trial.gap_min_rel.value, 0);
    EXPECT_LE(trial.gap_min_rel.value, 1.02 * trial.gap_rel_p05.value);
    EXPECT_LT(trial.gap_rel_p05.value, trial.gap_rel_p95.value);
    EXPECT_LE(trial.gap_rel_p95.value, 1.02);
    ++judged;
  }
  EXPECT_EQ(judged, 1);
}

TEST(StepState, OfTheTrialsOnlyThoseThatAreNamedAreTaken) {
  const std::vector<CorpusTrial> all = corpus_trials({}), few = corpus_trials({"pncg", "line_search/blend"});
  EXPECT_GT(all.size(), 10U);
  ASSERT_EQ(few.size(), 2U);
  EXPECT_EQ(trial_name(few[0]), "line_search/blend");
  EXPECT_EQ(trial_name(few[1]), "pncg");
  const StepState state = read_step_state(source / "results/steps", "twist_cloth");
  const CorpusState taken = take_state(state, {corpus_trials({"line_search/blend"})}, {}, {});
  ASSERT_EQ(taken.trials.size(), 1U);
  EXPECT_EQ(taken.trials[0].minimum, "A");
  EXPECT_GT(taken.trials[0].iterations, 2);
  EXPECT_GT(taken.trials[0].gap_min_rel.value, 0);
  const CorpusState alone = take_state(state, {few, false}, {}, {});
  EXPECT_FALSE(alone.has_reference);
  EXPECT_EQ(alone.trials[0].state_hash, taken.trials[0].state_hash);
  EXPECT_EQ(alone.trials[0].minimum, "");
  EXPECT_FALSE(alone.trials[0].error_m.finite());
  EXPECT_FALSE(alone.trials[1].refused.empty()) << "pncg takes no obstacle that moves";
}

TEST(StepState, AnUnknownTrialIsRefusedWithTheNamesThatThereAre) {
  try {
    corpus_trials({"line_search/blend", "newton"});
    FAIL() << "nothing was thrown";
  } catch (const ConfigError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("--trials"), std::string::npos) << text;
    EXPECT_NE(text.find("\"newton\""), std::string::npos) << text;
    EXPECT_NE(text.find("line_search/blend/exact_friction"), std::string::npos) << text;
  }
}

TEST(StepState, AMinimumBeyondTheAlphabetHasTwoLetters) {
  EXPECT_EQ(minimum_name(0), "A");
  EXPECT_EQ(minimum_name(25), "Z");
  EXPECT_EQ(minimum_name(26), "AA");
  EXPECT_EQ(minimum_name(52), "BA");
}

TEST(StepState, TheStatesOfTheRepositoryAreReadByThisProgram) {
  std::ifstream in(source / "configs/steps/corpus.json");
  const auto spec = nlohmann::json::parse(in);
  std::vector<std::string> listed;
  for (const auto& state : spec.at("states")) listed.push_back(state.at("name"));
  std::sort(listed.begin(), listed.end());
  const std::vector<std::string> names = step_states_in(source / "results/steps");
  EXPECT_EQ(names, listed);
  EXPECT_GT(names.size(), 15U);
  int tune = 0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const StepState state = read_step_state(source / "results/steps", names[i]);
    EXPECT_FALSE(state.hard_for.empty()) << names[i];
    EXPECT_EQ(state.split, i % 2 == 0 ? "tune" : "report") << names[i];
    tune += state.split == "tune";
  }
  EXPECT_GT(tune, 7);
}

}  // namespace
}  // namespace bb::step_state_test
