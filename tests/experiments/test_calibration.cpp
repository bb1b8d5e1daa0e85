// Matching from config to stiffness: what every formulation carries where the pilot's largest load was
// carried.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "barriers/shapes/registry.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/calibration.hpp"

namespace bb {
namespace {

/// The block of 0.3 kg on its three corners, already in contact: every number can be written down.
constexpr const char* block = R"({"schema": "barrierbench.config/1", "scene": {"name": "resting_block_1d"},
  "formulation": {"name": "cubic_dynamic", "d_hat_m": 0.01}, "matching": {"rule": "equal_force"},
  "time": {"steps": 20}})";

/// A cloth whose own d_hat is not the formulation's, dropped on a plane that it meets after some steps.
constexpr const char* falling = R"({"schema": "barrierbench.config/1",
  "scene": {"bodies": [{"name": "cloth", "mesh": {"generator": "grid", "n_x": 3, "n_y": 3}, "d_hat_m": 0.004,
                        "transform": {"translate_m": [0, 0, 0.03]}}],
            "obstacles": [{"name": "floor", "kind": "plane", "axis": [0, 0, 1]}]},
  "formulation": {"name": "cubic", "d_hat_m": 0.01}, "matching": {"rule": "equal_force"},
  "time": {"dt_s": 0.01, "steps": 20}})";

/// A cloth that hangs from two corners, its limit stiff by elasticity.
constexpr const char* hanging = R"({"schema": "barrierbench.config/1", "scene": {"name": "hang", "n": 4},
  "formulation": "cubic_dynamic", "matching": {"rule": "equal_force"}, "strain_limit": {"limit": 0.01},
  "time": {"steps": 25}})";

RunConfig parsed(const char* text, const std::vector<std::string>& overrides) {
  return parse_config(text, "test", ".", overrides);
}

struct Calibrated {
  RunConfig config;
  Scene scene;
  MatchingRecord record;
  Calibration calibration;
};

Calibrated calibrated(const char* text, const std::vector<std::string>& overrides = {}) {
  Calibrated out{parsed(text, overrides), {}, {}, {}};
  out.scene = build_scene(out.config);
  out.calibration = calibrate(out.config, out.scene, {}, out.record);
  return out;
}

double slope(const char* shape, double d, double d_hat) {
  return -BarrierFunction{require_shape(shape), Argument::gap}.eval(d, d_hat).db;
}

RunRecord run(const RunConfig& config) {
  RunOptions options;
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  options.folder = std::filesystem::temp_directory_path() /
                   ("barrierbench_run_" + std::string(test->name()) + "_" + std::to_string(::getpid()));
  RunRecord record = run_config(config, options);
  std::filesystem::remove_all(options.folder);
  return record;
}

TEST(Calibration, ADynamicPolicyCarriesTheLoadAtTheta) {
  const std::vector<std::string> mass_only = {"/formulation/stiffness_policy/elastic_term=false"};
  const Calibrated c = calibrated(block, mass_only);
  const double gap = 0.1 * 0.01, own = 0.1 / (gap * gap);  // m/d^2 of one corner
  EXPECT_EQ(c.record.load_source, "pilot");
  EXPECT_GT(c.record.load_N.value, 0.5);
  EXPECT_NEAR(c.calibration.scale * own * slope("cubic", gap, 0.01) / c.record.load_N.value, 1, 1e-9);
  EXPECT_EQ(c.record.scale.value, c.calibration.scale);
}

TEST(Calibration, TheConfigsOwnFactorActsAfterMatching) {
  const double once = calibrated(block).calibration.scale;
  EXPECT_EQ(calibrated(block, {"/formulation/stiffness_policy/scale=2"}).calibration.scale, once);
}

TEST(Calibration, EqualCurvatureHoldsAtHalfOfTheWidth) {
  const Calibrated c = calibrated(
      block, {"/formulation/stiffness_policy/elastic_term=false", "/matching/rule=equal_curvature"});
  const double gap = 0.5 * 0.01, own = 0.1 / (gap * gap);
  const double curvature = BarrierFunction{require_shape("cubic"), Argument::gap}.eval(gap, 0.01).d2b;
  EXPECT_NEAR(c.calibration.scale * own * curvature / c.record.curvature_N_per_m.value, 1, 1e-9);
}

TEST(Calibration, AMeasuredLoadBelongsToTheDHatOfItsContact) {
  const Calibrated fixed = calibrated(falling);
  EXPECT_EQ(fixed.record.load_source, "pilot");
  EXPECT_DOUBLE_EQ(fixed.record.d_hat_m.value, 0.004);
  EXPECT_NEAR(*fixed.calibration.kappa * slope("cubic", 0.0004, 0.004) / fixed.record.load_N.value, 1, 1e-12);
  EXPECT_GT(fixed.record.capacity_N.value, fixed.record.load_N.value);

  const Calibrated given = calibrated(falling, {"/matching/load_N=0.5"});
  EXPECT_EQ(given.record.load_source, "given");
  EXPECT_DOUBLE_EQ(given.record.d_hat_m.value, 0.01);
  EXPECT_NEAR(*given.calibration.kappa * slope("cubic", 0.001, 0.01), 0.5, 1e-12);
}

TEST(Calibration, FixedAndDynamicAgreeAtTheContactThatCarriedTheLoad) {
  const Calibrated fixed = calibrated(falling);
  const Calibrated dynamic = calibrated(
      falling, {R"(/formulation/stiffness_policy={"name": "elasticity_inclusive", "elastic_term": false})"});
  const PilotLoads& pilot = run_pilot(dynamic.config, dynamic.scene, {});
  ASSERT_EQ(pilot.row.n_free[0], 1);
  const double gap = 0.1 * 0.004, own = pilot.row.mass[0] / (gap * gap);
  EXPECT_NEAR(dynamic.calibration.scale * own / *fixed.calibration.kappa, 1, 1e-12);
}

TEST(Calibration, ADynamicLimitCarriesItsLoadAtTheta) {
  const Calibrated c = calibrated(hanging);
  const PilotLoads& pilot = run_pilot(c.config, c.scene, {});
  ASSERT_GT(pilot.limit, 0);
  EXPECT_EQ(c.record.limit_load_N_per_m.value, pilot.limit);
  const LimitColumns& e = pilot.element;
  EXPECT_NEAR(e.area, 0.5 / 9, 1e-12);  // 3 x 3 squares of 1 m^2, two triangles each
  Vec<double, 9> w;
  for (int k = 0; k < 3; ++k) w.segment<3>(3 * k) = e.x[k] - (e.x[0] + e.x[1] + e.x[2]) / 3;
  EXPECT_GT(w.dot(e.hessian * w), 0);
  const double width = c.scene.limit.width.front(), y = 0.1 * width;
  const double own = w.dot(e.hessian * w) + e.element_mass / (y * y);
  const double tension = c.calibration.limit_scale * own * slope("cubic", y, width) / e.area;
  EXPECT_NEAR(tension / pilot.limit, 1, 1e-9);
  EXPECT_EQ(c.record.limit_scale.value, c.calibration.limit_scale);
  EXPECT_EQ(make_method(c.config, c.calibration).limit_stiffness.multiplier, c.calibration.limit_scale);
}

TEST(Calibration, ALimitThatWasNeverActiveStaysAsGiven) {
  const Calibrated c = calibrated(block, {"/strain_limit/limit=0.5"});
  EXPECT_TRUE(c.calibration.limited);
  EXPECT_EQ(c.calibration.limit_scale, 1);
  EXPECT_FALSE(c.record.limit_scale.finite());
  EXPECT_EQ(c.record.limit_load_source, "static_weight");
  EXPECT_NE(c.record.pilot_note.find("the limit's policy stays as given"), std::string::npos)
      << c.record.pilot_note;
}

TEST(Calibration, TheRecordSaysWhereTheLimitsLoadComesFrom) {
  EXPECT_EQ(calibrated(block).record.limit_load_source, "none");
  EXPECT_EQ(calibrated(hanging).record.limit_load_source, "pilot");
  EXPECT_EQ(calibrated(hanging, {"/matching/limit_load_N_per_m=2"}).record.limit_load_source, "given");
}

/// Without a pilot's contact nobody can be asked, whatever the load.
TEST(Calibration, TheRecordSaysWhenAPolicyStaysAsGiven) {
  const std::string dynamic = R"(/formulation/stiffness_policy={"name": "elasticity_inclusive"})";
  for (const char* load : {"/matching/load_N=0.5", "/matching/theta=0.1"}) {
    const Calibrated c = calibrated(falling, {dynamic, "/time/steps=2", load});
    EXPECT_EQ(c.calibration.scale, 1);
    EXPECT_FALSE(c.record.scale.finite());
    EXPECT_EQ(c.record.pilot_note, "the contact policy stays as given: the pilot met no contact") << load;
  }
  EXPECT_EQ(calibrated(falling, {dynamic}).record.pilot_note, "");
  EXPECT_EQ(calibrated(falling, {"/time/steps=2"}).record.pilot_note, "");  // a fixed kappa from the weight
}

TEST(Calibration, ALimitOnNothingNeedsNoStiffness) {
  const RunConfig config =
      parsed(falling, {"/strain_limit/limit=0.1", "/scene/bodies/0/limited=false", "/time/steps=8"});
  const RunRecord record = run(config);
  EXPECT_EQ(record.status.outcome, Outcome::ok) << record.status.detail;
}

TEST(Calibration, AnAdaptiveKappaStartsAtTheMatchedValue) {
  for (const char* text : {block, falling}) {
    const Calibrated c = calibrated(text, {"/formulation=ipc2020"});
    const double d_hat = c.record.d_hat_m.value;
    const BarrierFunction log{require_shape("log"), Argument::squared_gap};
    const double matched = c.record.load_N.value / -log.eval(0.1 * d_hat, d_hat).db;
    ASSERT_TRUE(c.record.scale.finite());
    const RunRecord scaled = run(c.config);
    EXPECT_NEAR(scaled.summary.stiffness.kappa_start_N_per_m.value / matched, 1, 1e-9);
    RunConfig given = c.config;
    given.matching.rule = MatchingRule::as_given;
    const double start = run(given).summary.stiffness.kappa_start_N_per_m.value;
    EXPECT_GT(std::abs(start / matched - 1), 0.01);  // else the test shows nothing
    EXPECT_NEAR(c.record.scale.value * start / matched, 1, 1e-9);
  }
}

TEST(Calibration, TheBoundsOfAnAdaptiveKappaComeFromTheConfig) {
  const std::vector<std::string> bounds = {"/formulation=ipc2020", "/matching/rule=as_given",
                                           "/formulation/stiffness_policy/kappa_min_N_per_m=123",
                                           "/formulation/stiffness_policy/kappa_max_N_per_m=123"};
  const RunRecord record = run(parsed(block, bounds));
  EXPECT_EQ(record.summary.stiffness.kappa_start_N_per_m.value, 123);
  EXPECT_TRUE(record.summary.stiffness.saturated);
}

/// A flat, unstrained block has no elastic stiffness along the normal: nothing can be scaled to the load.
TEST(Calibration, WhatOnlyThePilotTellsIsAnOutcome) {
  const RunRecord record = run(parsed(block, {"/formulation/stiffness_policy/mass_term=none"}));
  EXPECT_EQ(record.status.outcome, Outcome::invalid_scene);
  EXPECT_NE(record.status.detail.find("matching: found kappa = "), std::string::npos) << record.status.detail;
  EXPECT_EQ(record.labels.matching_rule, "equal_force");
  EXPECT_EQ(record.summary.steps, 0);
}

}  // namespace
}  // namespace bb
