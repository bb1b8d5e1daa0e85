// Matching of contacts from config to stiffness: what every formulation carries of the loads that
// the calibration run met.
#include <algorithm>
#include <cmath>

#include "tests/experiments/calibrated.hpp"

namespace bb::calibration_test {
namespace {

using namespace test;

TEST(Calibration, EveryContactOfTheCalibrationRunIsCarriedAtTheta) {
  const Calibrated c = calibrated(two_masses);
  const std::vector<VertexLoad> loads = loads_on_plane(c);
  ASSERT_EQ(c.record.contacts_considered, static_cast<long long>(loads.size()));
  const VertexLoad* largest = &loads.front();
  double tightest = 0;
  for (const VertexLoad& one : loads) {
    const double carried = c.calibration.scale * softest(one.mass, one.d_hat) * slope("cubic", 0.001, 0.01);
    EXPECT_LE(one.load, carried * (1 + 1e-9));
    tightest = std::max(tightest, one.load / carried);
    if (one.load > largest->load) largest = &one;
  }
  EXPECT_NEAR(tightest, 1, 1e-9);
  EXPECT_EQ(c.scene.bodies[static_cast<std::size_t>(largest->body)].name, "heavy");
  EXPECT_NE(c.record.contact.find("light["), std::string::npos) << c.record.contact;
  EXPECT_LT(c.record.load_N.value, largest->load);
  EXPECT_GE(c.record.contact_step.value, 0);
}

/// kappa = m/(c h^2) with c = 1 in the step that starts BDF2 and 4/9 in the others: the light cloth hits the
/// plane in the first one and bounces, the heavy one comes to rest on it.
TEST(Calibration, APolicyWithTheInertiaTermIsAskedWithTheWeightOfEachStep) {
  const Calibrated c = calibrated(
      two_masses, {R"(/integrator/name="bdf2")", R"(/formulation/stiffness_policy/mass_term="inertia")"});
  double tightest = 0, with_one = 0, with_the_other = 0;
  std::size_t in_first_step = 0;
  for (const VertexLoad& one : loads_on_plane(c)) {
    const double needed = one.load * 0.01 * 0.01 / (one.mass * slope("cubic", 0.001, 0.01));  // s of c = 1
    with_one = std::max(with_one, needed);
    with_the_other = std::max(with_the_other, needed * 4 / 9);
    tightest = std::max(tightest, one.step == 0 ? needed : needed * 4 / 9);
    in_first_step += one.step == 0;
  }
  EXPECT_GT(in_first_step, 0U);
  EXPECT_GT(tightest, 0);
  EXPECT_NEAR(c.calibration.scale / tightest, 1, 1e-9);
  EXPECT_LT(tightest, 0.99 * with_one);
  EXPECT_GT(tightest, 1.01 * with_the_other);
}

/// With s from the contact of the largest load alone, the other one overloads.
TEST(Calibration, ARunMatchedAtAllContactsIsCarriedAndOneMatchedAtTheLargestLoadIsNot) {
  const Calibrated c = calibrated(two_masses);
  const RunRecord all = run(c.config);
  EXPECT_EQ(all.status.outcome, Outcome::ok) << all.status.detail;
  EXPECT_GT(all.summary.contact_load_max_N.value, 0);
  const std::vector<VertexLoad> loads = loads_on_plane(c);
  const VertexLoad largest = *std::max_element(
      loads.begin(), loads.end(), [](const VertexLoad& a, const VertexLoad& b) { return a.load < b.load; });
  RunConfig one = c.config;
  one.matching.rule = MatchingRule::as_given;
  one.formulation.stiffness_policy.scale =
      largest.load / (slope("cubic", 0.001, 0.01) * softest(largest.mass, largest.d_hat));
  EXPECT_EQ(run(one).status.outcome, Outcome::stall_overload);
}

/// kappa = m/d^2 refreshed in every iteration cycles below d_hat/2; matched, it rests at d_hat/(2 - theta).
TEST(Calibration, APolicyRefreshedInEveryIterationComesToRest) {
  const Calibrated c = calibrated(block, {"/formulation/stiffness_policy/elastic_term=false"});
  EXPECT_EQ(c.record.load_source, "pilot");
  EXPECT_GT(c.record.load_N.value, 0.5);
  EXPECT_NEAR(c.calibration.scale * softest(0.1, 0.01) * slope("cubic", 0.001, 0.01) / c.record.load_N.value,
              1, 1e-9);
  EXPECT_EQ(c.record.scale.value, c.calibration.scale);
  const RunRecord record = run(c.config);
  EXPECT_EQ(record.status.outcome, Outcome::ok) << record.status.detail;
  EXPECT_GT(record.summary.gap_min_rel.min.value, 0.5);
  EXPECT_LT(record.summary.gap_min_rel.min.value, 1);
}

/// A step that did not converge is in no balance: what it holds is no load.
TEST(Calibration, TheCalibrationRunTakesNoLoadFromAStepThatDidNotConverge) {
  const std::string cubic = R"(/formulation={"name": "cubic", "d_hat_m": 0.01})";
  const std::string later = "/scene/bodies/1/transform/translate_m=[3, 0, 0.08]";
  const Calibrated capped = calibrated(two_masses, {cubic, later, "/step_solver/max_iterations=4"});
  const std::shared_ptr<const CalibrationRun> kept = run_calibration(capped.config, capped.scene, {});
  const CalibrationRun& calibration_run = *kept;
  ASSERT_NE(calibration_run.stopped.find("iteration_cap"), std::string::npos) << calibration_run.stopped;
  ASSERT_GT(calibration_run.steps(), 0);
  EXPECT_NE(calibration_run.stopped.find("step " + std::to_string(calibration_run.steps()) + " "),
            std::string::npos)
      << calibration_run.stopped;
  EXPECT_EQ(capped.record.pilot_note, calibration_run.stopped);
  const Calibrated shorter =
      calibrated(two_masses, {cubic, later, "/time/steps=" + std::to_string(calibration_run.steps())});
  EXPECT_EQ(run_calibration(shorter.config, shorter.scene, {})->stopped, "");
  EXPECT_GT(capped.record.contacts_considered, 0);
  EXPECT_EQ(capped.record.contacts_considered, shorter.record.contacts_considered);
  EXPECT_EQ(capped.record.load_N.value, shorter.record.load_N.value);
}

TEST(Calibration, TheConfigsOwnFactorActsAfterMatching) {
  const double once = calibrated(block).calibration.scale;
  EXPECT_EQ(calibrated(block, {"/formulation/stiffness_policy/scale=2"}).calibration.scale, once);
}

TEST(Calibration, EqualCurvatureHoldsAtHalfOfTheWidth) {
  const Calibrated c = calibrated(
      block, {"/formulation/stiffness_policy/elastic_term=false", "/matching/rule=equal_curvature"});
  const double gap = 0.5 * 0.01, own = softest(0.1, 0.01);
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

/// A smaller load over a smaller d_hat may require more.
TEST(Calibration, OneKappaCarriesTheLoadsOfEveryDHat) {
  const std::vector<std::string> fixed = {"/formulation=cubic", "/scene/bodies/1/d_hat_m=0.001"};
  const Calibrated c = calibrated(two_masses, fixed);
  double largest = 0, tightest = 0;
  for (const VertexLoad& one : loads_on_plane(c)) {
    largest = std::max(largest, one.load);
    const double carried = *c.calibration.kappa * slope("cubic", 0.1 * one.d_hat, one.d_hat);
    tightest = std::max(tightest, one.load / carried);
  }
  EXPECT_NEAR(tightest, 1, 1e-9);
  EXPECT_DOUBLE_EQ(c.record.d_hat_m.value, 0.001);
  EXPECT_LT(c.record.load_N.value, largest);  // else the test shows nothing
}

/// Without a contact in the calibration run there is no stiffness to scale, whatever the load.
TEST(Calibration, TheRecordSaysWhenAPolicyStaysAsGiven) {
  const std::string dynamic = R"(/formulation/stiffness_policy={"name": "elasticity_inclusive"})";
  for (const char* load : {"/matching/load_N=0.5", "/matching/theta=0.1"}) {
    const Calibrated c = calibrated(falling, {dynamic, "/time/steps=2", load});
    EXPECT_EQ(c.calibration.scale, 1);
    EXPECT_FALSE(c.record.scale.finite());
    EXPECT_EQ(c.record.pilot_note, "the contact policy stays as given: the calibration run met no contact")
        << load;
    EXPECT_EQ(c.record.contacts_considered, 0);
    EXPECT_EQ(c.record.contact, "");
  }
  EXPECT_EQ(calibrated(falling, {dynamic}).record.pilot_note, "");
  EXPECT_EQ(calibrated(falling, {"/time/steps=2"}).record.pilot_note, "");  // a fixed kappa from the weight
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
TEST(Calibration, WhatOnlyTheCalibrationRunTellsIsAnOutcome) {
  const RunRecord record = run(parsed(block, {"/formulation/stiffness_policy/mass_term=none"}));
  EXPECT_EQ(record.status.outcome, Outcome::invalid_scene);
  EXPECT_NE(record.status.detail.find("matching: found kappa = "), std::string::npos) << record.status.detail;
  EXPECT_EQ(record.matching.rule, "equal_force");
  EXPECT_EQ(record.summary.steps, 0);
}

}  // namespace
}  // namespace bb::calibration_test
