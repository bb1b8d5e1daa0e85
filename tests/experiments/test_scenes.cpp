// Scenes as their users run them: from a config to a record, with the physics that has to come out.
#include <gtest/gtest.h>

#include <cmath>

#include <filesystem>

#include "barriers/matching.hpp"
#include "barriers/shapes/registry.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/runner.hpp"
#include "experiments/scenes/procedural_scene.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::scenes_test {
namespace {

class Scenes : public ::testing::Test {
 protected:
  RunRecord run(const std::string& text, std::vector<std::string> overrides = {}) const {
    RunOptions options;
    options.folder = folder_;
    options.replace = Replace::all;  // the runs of a test follow one another there
    return run_config(parse_config(text, "test", ".", overrides), options);
  }
  test::TemporaryFolder folder_;
};

const std::vector<std::string> watched = {"/passes={\"time\": true, \"diagnose\": true, \"audit\": true}"};

void expect_clean(const RunRecord& record, const std::string& what) {
  EXPECT_EQ(record.status.outcome, Outcome::ok) << what << ": " << record.status.detail;
  EXPECT_TRUE(record.validity.valid) << what;
  EXPECT_GT(record.audit.motions, 0) << what;
  EXPECT_GT(record.audit.judged, 0) << what;
  EXPECT_GT(record.audit.edges, 0) << what;
  EXPECT_EQ(record.audit.crossings + record.audit.violations + record.audit.unproven, 0) << what;
}

TEST_F(Scenes, AllOfTheRegistryTakeTheirFirstSteps) {
  for (const ProceduralScene& scene : procedural_scenes()) {
    const std::string text = R"({"schema": "barrierbench.config/1", "scene": {"name": ")" +
                             std::string(scene.name) + R"("}, "formulation": "log",
      "time": {"steps": 3}})";
    const RunRecord record = run(text, watched);
    expect_clean(record, std::string(scene.name));
    EXPECT_EQ(record.summary.steps, 3);
    EXPECT_GT(record.summary.newton_iterations, 2) << scene.name;
  }
}

TEST_F(Scenes, RestingBlockRestsAtTheClosedForm) {
  const double d_hat = 0.01, kappa = 1000;
  for (const char* name : {"log", "quadratic", "cubic", "log_squared", "two_stage", "exponential",
                           "exponential:8", "minimax_bounded", "minimax", "minimax:12"}) {
    const RunConfig config = parse_config(
        R"({"schema": "barrierbench.config/1", "scene": {"name": "resting_block_1d"}, "formulation": {"argument": "gap", "shape": ")" +
            std::string(name) +
            R"(", "stiffness_policy": {"name": "fixed", "kappa_N_per_m": 1000}},
          "time": {"steps": 600}, "step_solver": {"tol_velocity_m_per_s": 1e-9}})",
        "test");
    RunOptions options;
    options.folder = folder_;
    options.replace = Replace::all;  // the runs of a test follow one another there
    const RunRecord record = run_config(config, options);
    ASSERT_EQ(record.status.outcome, Outcome::ok) << record.status.detail;
    const BarrierFunction barrier{require_shape(name), Argument::gap};
    const double load =
        number(config.scene.parameters, "mass_kg") * number(config.scene.parameters, "gravity_m_per_s2") / 3;
    const auto expected = equilibrium(barrier, kappa, d_hat, load);
    ASSERT_TRUE(expected.d.has_value());
    EXPECT_NEAR(record.steps.back().gap_min_m.value / *expected.d, 1, 1e-6) << name;
    EXPECT_NEAR(record.steps.back().contact_load_sum_N.value, 3 * load, 1e-5 * load) << name;
  }
}

TEST_F(Scenes, DrapeBringsAllLayersAndTheSphereInContactWithoutACrossing) {
  const std::string text =
      R"({"schema": "barrierbench.config/1", "scene": {"name": "drape", "layers": 3, "n": 7}, "formulation": "log",
    "time": {"steps": 12}})";
  for (const char* sphere : {"\"analytic\"", "\"mesh\""}) {
    std::vector<std::string> overrides = watched;
    overrides.push_back(std::string("/scene/sphere=") + sphere);
    const RunRecord record = run(text, overrides);
    expect_clean(record, sphere);
    for (const char* pair : {"layer0|sphere", "layer0|layer1", "layer1|layer2"}) {
      EXPECT_TRUE(record.summary.first_contact.contains(pair)) << sphere << " " << pair;
    }
    EXPECT_GT(record.summary.max_stretch.value, 0.002);
    EXPECT_LT(record.summary.max_stretch.value, 0.02);
    EXPECT_GT(record.summary.gap_min_m.value, 0);
  }
}

const std::string drape2d_cubic =
    R"({"schema": "barrierbench.config/1", "scene": {"name": "drape2d", "n": 10}, "formulation": "cubic",
        "matching": {"rule": "equal_force"}, "time": {"steps": 20}})";

TEST_F(Scenes, EveryVariantOfDrape2dTouchesAndKeepsItsLimit) {
  for (const char* variant : {"pinned", "free", "strip", "stack"}) {
    for (const char* pairs : {"vertex_vertex", "point_edge"}) {
      std::vector<std::string> overrides = watched;
      overrides.push_back("/scene/variant=\"" + std::string(variant) + "\"");
      overrides.push_back("/scene/pairs=\"" + std::string(pairs) + "\"");
      const RunRecord record = run(drape2d_cubic, overrides);
      if (record.status.outcome != Outcome::penetration) {
        expect_clean(record, std::string(variant) + " " + pairs);
        EXPECT_GT(record.audit.surface_gap_obstacles_m.value, 0) << variant << " " << pairs;
      } else {  // without edge pairs edges may cross each other and enter the disk, and the audit sees it
        EXPECT_STREQ(pairs, "vertex_vertex");
        EXPECT_NE(record.status.detail.find("vertex_vertex"), std::string::npos) << record.status.detail;
        if (std::string(variant) == "stack") {
          EXPECT_GT(record.audit.crossings, 0);
        } else {
          EXPECT_GT(record.audit.obstacle_violations, 0) << variant;
          EXPECT_LT(record.audit.surface_gap_obstacles_m.value, 0) << variant;
        }
        EXPECT_FALSE(record.validity.valid);
      }
      EXPECT_GT(record.summary.contacts.max.value, 0) << variant;
      EXPECT_LT(record.summary.max_stretch.value, 0.02) << variant;
      EXPECT_EQ(record.matching.load_source, "pilot") << variant;
    }
  }
}

TEST_F(Scenes, TheArticlesClampHidesAStretchBeyondTheLimit) {
  std::vector<std::string> overrides = watched;
  overrides.emplace_back("/time/steps=3");
  const std::string text =
      R"({"schema": "barrierbench.config/1", "scene": {"name": "drape2d", "variant": "pinned", "protocol": "article_literal"},
    "formulation": {"name": "log", "stiffness_policy": {"kappa_N_per_m": 1}},
    "strain_limit": {"shape": "log", "stiffness_policy": {"k_s_N_per_m": 1}},
    "matching": {"rule": "as_given"}})";
  const RunRecord record = run(text, overrides);

  EXPECT_EQ(record.labels.step_solver, "article_literal");
  EXPECT_GT(record.summary.max_stretch.value, 0.02);
  EXPECT_FALSE(record.validity.valid);
  EXPECT_GT(record.summary.cond.at("full/none").statuses.at("lower_bound"), 0);  // above 1e14
  overrides.emplace_back("/scene/protocol=\"equal_force\"");
  const RunRecord common = run(text, overrides);
  EXPECT_LT(common.summary.max_stretch.value, 0.02);
  EXPECT_LT(common.summary.cond.at("full/none").log10_cond.max.value, 14);
}

TEST_F(Scenes, CrossingsThatTheContactModelLeavesOutAreCounted) {
  const std::string stack =
      R"({"schema": "barrierbench.config/1", "scene": {"name": "drape2d", "variant": "stack"}, "formulation": "log",
        "matching": {"rule": "equal_force"}, "time": {"steps": 20}})";
  const RunRecord vertices = run(stack, {"/scene/pairs=\"vertex_vertex\""});
  EXPECT_EQ(vertices.status.outcome, Outcome::penetration);
  EXPECT_GT(vertices.audit.crossings, 100);
  EXPECT_EQ(vertices.audit.edges, 120);
  EXPECT_FALSE(vertices.validity.valid);
  const RunRecord edges = run(stack);  // the default
  expect_clean(edges, "point_edge");
  EXPECT_EQ(edges.audit.edges, 120);
  EXPECT_GT(edges.audit.motion_pairs, 0);
}

TEST_F(Scenes, VerticesThatFallThroughTheDiskAreAPenetration) {
  const RunRecord record = run(
      R"({"schema": "barrierbench.config/1", "scene": {"name": "drape2d", "variant": "free", "protocol": "article_literal", "pairs": "vertex_vertex"},
    "formulation": {"name": "article_cubic", "stiffness_policy": {"kappa_a_J": 1e-4}},
    "strain_limit": {"enabled": false}, "matching": {"rule": "as_given"}})");
  EXPECT_LT(record.summary.gap_min_m.value, -0.05);
  EXPECT_GT(record.audit.obstacle_violations, 0);
  EXPECT_EQ(record.status.outcome, Outcome::penetration);
  EXPECT_NE(record.status.detail.find("disk"), std::string::npos) << record.status.detail;
}

std::string plates(const std::string& lower_motion, const std::string& upper_motion, double height) {
  return R"({"schema": "barrierbench.config/1", "formulation": {"name": "log", "d_hat_m": 0.01, "stiffness_policy": {"kappa_N_per_m": 1}},
    "scene": {"bodies": [
      {"name": "cloth", "mesh": {"generator": "grid", "n_x": 3, "n_y": 3}, "transform": {"translate_m": [0, 0, 5]}},
      {"name": "lower", "kind": "rigid", "mesh": {"generator": "grid", "n_x": 3, "n_y": 3})" +
         lower_motion + R"(},
      {"name": "upper", "kind": "rigid", "mesh": {"generator": "grid", "n_x": 3, "n_y": 3},
       "transform": {"axis": [1, 0, 0], "angle_deg": 90, "translate_m": [0.1, 0.1, )" +
         std::to_string(height) + "]}" + upper_motion + R"(}]},
    "time": {"dt_s": 0.01, "steps": 10}})";
}

TEST_F(Scenes, PrescribedBodiesThatCrossAreTheScenesFault) {
  const std::string still, down = R"(, "motion": {"velocity_m_per_s": [0, 0, -10]})";
  const RunRecord apart = run(plates(still, still, 0.7));
  EXPECT_EQ(apart.status.outcome, Outcome::ok) << apart.status.detail;
  for (const auto& [motion, height] : {std::pair{still, 0.05}, std::pair{down, 0.7}}) {
    for (const char* audit : {"true", "false"}) {
      const RunRecord record = run(plates(still, motion, height), {std::string("/passes/audit=") + audit});
      EXPECT_EQ(record.status.outcome, Outcome::given_parts_cross) << record.status.detail;
      EXPECT_EQ(record.summary.steps, 0);
      for (const char* name : {"lower[", "upper["}) {
        EXPECT_NE(record.status.detail.find(name), std::string::npos) << record.status.detail;
      }
    }
  }
  const RunRecord together = run(plates(down, down, 0.7));  // no motion between them
  EXPECT_EQ(together.status.outcome, Outcome::ok) << together.status.detail;
}

TEST_F(Scenes, GapsOfARunAreThoseOfConvergedStepEnds) {
  const std::string text =
      R"({"schema": "barrierbench.config/1", "scene": {"name": "drape2d", "variant": "strip"}, "formulation": "log",
        "matching": {"rule": "equal_force"}, "time": {"steps": 12}})";
  const RunRecord all = run(text);
  ASSERT_EQ(all.status.outcome, Outcome::ok) << all.status.detail;
  double smallest = 1, of_iterates = 1;
  int deeper = 0;
  for (const StepRecord& step : all.steps) {
    if (!step.gap_min_rel.finite()) continue;
    ASSERT_LE(step.gap_min_iterates_rel.value, step.gap_min_rel.value);
    deeper += step.gap_min_iterates_rel.value < step.gap_min_rel.value;
    EXPECT_NEAR(step.gap_min_m.value / step.gap_min_rel.value, 0.01, 1e-12);  // one d_hat in this scene
    smallest = std::min(smallest, step.gap_min_rel.value);
    of_iterates = std::min(of_iterates, step.gap_min_iterates_rel.value);
  }
  EXPECT_GT(deeper, 0);
  EXPECT_EQ(all.summary.gap_min_rel.min.value, smallest);
  EXPECT_EQ(all.summary.gap_min_iterates_rel.value, of_iterates);
  EXPECT_NEAR(all.summary.gap_min_m.value, 0.01 * smallest, 1e-14);
  EXPECT_NEAR(all.summary.gap_min_iterates_m.value, 0.01 * of_iterates, 1e-14);

  const RunRecord capped = run(text, {"/step_solver/max_iterations=2"});
  ASSERT_NE(capped.status.outcome, Outcome::ok);
  const StepRecord& last = capped.steps.back();
  ASSERT_GT(last.contacts.total(), 0U);
  EXPECT_FALSE(last.gap_min_rel.finite());
  EXPECT_STREQ(last.gap_min_m.status, "not_converged");
  EXPECT_TRUE(last.gap_min_iterates_rel.finite());
  EXPECT_EQ(capped.comparability.verdict, "not_valid");
}

TEST_F(Scenes, AreBitIdenticalForAnyNumberOfThreadsAndRerunFromTheirRecord) {
  for (const char* formulation :
       {"log", "cubic_dynamic_lagged", "cubic_dynamic_consistent", "cubic_dynamic_consistent_scaled"}) {
    const std::string text =
        R"({"schema": "barrierbench.config/1", "scene": {"name": "drape", "layers": 2, "n": 8}, "time": {"steps": 8},
      "formulation": ")" +
        std::string(formulation) + R"("})";
    const RunRecord one = run(text, {"/threads=1"}), two = run(text, {"/threads=2"});
    ASSERT_EQ(one.status.outcome, Outcome::ok) << one.status.detail;
    EXPECT_GT(one.summary.contacts.max.value, 10);
    EXPECT_EQ(one.summary.state_hash.size(), 64U);
    EXPECT_EQ(one.summary.state_hash, two.summary.state_hash) << formulation;
    EXPECT_EQ(run(one.config.text).summary.state_hash, one.summary.state_hash) << formulation;
  }
}

}  // namespace
}  // namespace bb::scenes_test
