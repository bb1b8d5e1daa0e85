// Matching from config to stiffness: what every formulation carries of the loads that the pilot met.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

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

/// Two cloths without stiffness against the normal fall on a plane: the heavy one has the largest load, the
/// light and fast one the largest load for its mass.
constexpr const char* two_masses = R"({"schema": "barrierbench.config/1",
  "scene": {"bodies": [{"name": "heavy", "mesh": {"generator": "grid", "n_x": 2, "n_y": 2}, "material": {"density_kg_per_m2": 2},
                        "velocity_m_per_s": [0, 0, -0.1], "transform": {"translate_m": [0, 0, 0.015]}},
                       {"name": "light", "mesh": {"generator": "grid", "n_x": 2, "n_y": 2}, "material": {"density_kg_per_m2": 0.2},
                        "velocity_m_per_s": [0, 0, -2], "transform": {"translate_m": [3, 0, 0.0115]}}],
            "obstacles": [{"name": "floor", "kind": "plane", "axis": [0, 0, 1]}]},
  "formulation": {"name": "cubic_dynamic_lagged", "d_hat_m": 0.01,
                  "stiffness_policy": {"name": "elasticity_inclusive", "elastic_term": false, "refresh": "per_step"}},
  "matching": {"rule": "equal_force"}, "time": {"dt_s": 0.01, "steps": 12}})";

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

/// A load of the pilot and the vertex that carried it, on the plane z = 0.
struct VertexLoad {
  double load, mass, d_hat;  // N, kg, m
  int body;
  std::size_t step;
};

/// Every load over the converged step ends of the pilot.
std::vector<VertexLoad> loads_on_plane(const Calibrated& c) {
  const std::shared_ptr<const Pilot> kept = run_pilot(c.config, c.scene, {});
  const Pilot& pilot = *kept;
  std::vector<VertexLoad> out;
  for (std::size_t step = 1; step < pilot.x.size(); ++step) {
    for (int v = 0; v < c.scene.n_vertices(); ++v) {
      const auto i = static_cast<std::size_t>(v);
      const double d = pilot.x[step](2, v), d_hat = c.scene.d_hat[i];
      if (d >= d_hat) continue;
      out.push_back({*pilot.stiffness.kappa * -log_barrier().eval(d, d_hat).db, c.scene.mass[i], d_hat,
                     c.scene.body[i], step - 1});
    }
  }
  return out;
}

/// The smallest that a policy kappa = m/d^2 can be inside the support: at d_hat.
double softest(double mass, double d_hat) { return mass / (d_hat * d_hat); }

TEST(Calibration, EveryContactOfThePilotIsCarriedAtTheta) {
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
TEST(Calibration, ThePilotTakesNoLoadFromAStepThatDidNotConverge) {
  const std::string cubic = R"(/formulation={"name": "cubic", "d_hat_m": 0.01})";
  const std::string later = "/scene/bodies/1/transform/translate_m=[3, 0, 0.08]";
  const Calibrated capped = calibrated(two_masses, {cubic, later, "/step_solver/max_iterations=4"});
  const std::shared_ptr<const Pilot> kept = run_pilot(capped.config, capped.scene, {});
  const Pilot& pilot = *kept;
  ASSERT_NE(pilot.stopped.find("iteration_cap"), std::string::npos) << pilot.stopped;
  ASSERT_GT(pilot.steps(), 0);
  EXPECT_NE(pilot.stopped.find("step " + std::to_string(pilot.steps()) + " "), std::string::npos)
      << pilot.stopped;
  EXPECT_EQ(capped.record.pilot_note, pilot.stopped);
  const Calibrated shorter =
      calibrated(two_masses, {cubic, later, "/time/steps=" + std::to_string(pilot.steps())});
  EXPECT_EQ(run_pilot(shorter.config, shorter.scene, {})->stopped, "");
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

/// A smaller load over a smaller d_hat may ask for more.
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

/// The limit of the pinned sheet: at its width, and frozen for a step at the wider gap that a slack element
/// had at the step's start, its own stiffness times s carries what the pilot carried.
TEST(Calibration, ADynamicLimitCarriesThePilotsLoads) {
  const std::string text =
      R"({"schema": "barrierbench.config/1", "scene": {"name": "drape2d", "variant": "pinned"},
    "formulation": "cubic_dynamic", "strain_limit": {"shape": "cubic"}, "matching": {"rule": "equal_force"}})";
  double scale[2];
  for (const bool lagged : {false, true}) {
    std::vector<std::string> changes;
    if (lagged) changes = {"/formulation=cubic_dynamic_lagged"};
    const Calibrated c = calibrated(text.c_str(), changes);
    EXPECT_EQ(c.record.limit_load_source, "pilot");
    EXPECT_GT(c.record.elements_considered, 100);
    EXPECT_NE(c.record.limit_element.find("sheet["), std::string::npos) << c.record.limit_element;
    EXPECT_GE(c.record.limit_step.value, 0);
    EXPECT_EQ(c.record.limit_scale.value, c.calibration.limit_scale);
    EXPECT_EQ(make_method(c.config, c.calibration).limit_stiffness.multiplier, c.calibration.limit_scale);
    scale[lagged] = c.calibration.limit_scale;
    const RunRecord record = run(c.config);
    EXPECT_EQ(record.status.outcome, Outcome::ok) << record.status.detail;
    EXPECT_GT(record.summary.limit_load_max_N_per_m.value, 0);
  }
  EXPECT_GT(scale[1], 1.2 * scale[0]);  // 1.37: asked at the width alone, frozen or not makes no difference
}

/// kappa_e = w^T M w/(c h^2) by hand for every element that the pilot stretched into its limit, and the load
/// that it carried there: s makes the neediest one as stiff as the fixed limit matched to its load.
TEST(Calibration, TheScaleOfADynamicLimitIsThatOfItsNeediestElement) {
  const Calibrated c = calibrated(
      R"({"schema": "barrierbench.config/1", "scene": {"name": "drape2d", "variant": "pinned"},
    "formulation": "cubic", "strain_limit": {"shape": "cubic", "stiffness_policy":
      {"name": "elasticity_inclusive", "mass_term": "inertia", "elastic_term": false}},
    "matching": {"rule": "equal_force"}, "time": {"steps": 30}})");
  const std::shared_ptr<const Pilot> pilot = run_pilot(c.config, c.scene, {});
  const double h = c.config.time.dt;
  double needed = 0, smallest_area = 1, largest_area = 0;
  long long active = 0;
  for (std::size_t step = 0; step + 1 < pilot->x.size(); ++step) {
    for (std::size_t e = 0; e < c.scene.limit.triangles.size(); ++e) {
      const auto& t = c.scene.limit.triangles[e];
      Eigen::Matrix2d rest, now;
      Eigen::Matrix<double, 2, 3> start;
      for (int k = 0; k < 3; ++k) start.col(k) = pilot->x[step].col(t[static_cast<std::size_t>(k)]).head<2>();
      for (int k = 0; k < 2; ++k) {
        rest.col(k) =
            (c.scene.rest.col(t[static_cast<std::size_t>(k) + 1]) - c.scene.rest.col(t[0])).head<2>();
        now.col(k) =
            (pilot->x[step + 1].col(t[static_cast<std::size_t>(k) + 1]) - pilot->x[step + 1].col(t[0]))
                .head<2>();
      }
      const double width = c.scene.limit.width[e], area = std::abs(rest.determinant()) / 2;
      const double sigma = Eigen::JacobiSVD<Eigen::Matrix2d>(now * rest.inverse()).singularValues()[0];
      const double y = width - (sigma - 1 - c.scene.limit.onset[e]);
      if (!(y < width)) continue;
      ++active;
      smallest_area = std::min(smallest_area, area), largest_area = std::max(largest_area, area);
      double kappa = 0;
      for (int k = 0; k < 3; ++k) {
        kappa += c.scene.mass[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])] *
                 (start.col(k) - start.rowwise().mean()).squaredNorm() / (h * h);
      }
      const double load = *pilot->stiffness.k_s * -log_barrier().eval(y, width).db;  // N/m
      needed = std::max(needed, load * area / (kappa * slope("cubic", 0.1 * width, width)));
    }
  }
  EXPECT_GT(active, 100);
  EXPECT_EQ(c.record.elements_considered, active);
  EXPECT_LT(largest_area, 0.5);  // else a forgotten area shows nothing
  EXPECT_NEAR(c.calibration.limit_scale / needed, 1, 1e-6);
}

TEST(PilotCache, KeepsWhatWasAskedForLastWithinItsBytes) {
  const auto pilot = [](const char* id, int states) {
    Pilot out;
    out.config_id = id;
    out.x.assign(static_cast<std::size_t>(states), Positions::Zero(3, 10));  // 240 bytes each
    return out;
  };
  PilotCache cache(1000);
  cache.keep(pilot("a", 2));
  cache.keep(pilot("b", 2));
  ASSERT_NE(cache.find("a"), nullptr);
  const auto held = cache.find("b");
  EXPECT_NE(cache.find("a"), nullptr);
  cache.keep(pilot("c", 1));  // 1200 bytes with both: b was not asked for longest
  EXPECT_EQ(cache.find("b"), nullptr);
  EXPECT_NE(cache.find("a"), nullptr);
  EXPECT_EQ(held->config_id, "b");  // whoever has it keeps it
  EXPECT_EQ(cache.keep(pilot("large", 100))->config_id, "large");
  EXPECT_NE(cache.find("large"), nullptr);
  EXPECT_EQ(cache.find("a"), nullptr);
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
    EXPECT_EQ(c.record.contacts_considered, 0);
    EXPECT_EQ(c.record.contact, "");
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
  EXPECT_EQ(record.matching.rule, "equal_force");
  EXPECT_EQ(record.summary.steps, 0);
}

}  // namespace
}  // namespace bb
