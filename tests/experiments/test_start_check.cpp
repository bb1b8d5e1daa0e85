// What is reported of a scene before its first step: given surfaces that pass through each other in any position, given motions
// that cross, and a time limit that comes first.
#include "experiments/run/start_check.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "core/base/record/phase_times.hpp"
#include "core/math/stop_request.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/pass.hpp"
#include "experiments/run/plan.hpp"
#include "experiments/run/recorder.hpp"
#include "experiments/run/runner.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::start_check_test {
namespace {

constexpr const char* material = R"("limited": false, "material": {"model": "corotational",
  "youngs_N_per_m": 250, "poisson": 0.24, "density_kg_per_m2": 0.15})";

/// Bodies beside a free sheet far above, and steps of 10 ms.
RunConfig config_of(const std::string& bodies, int steps) {
  return parse_config(
      fmt::format(R"({{"schema": "barrierbench.config/1", "formulation": {{"name": "log", "d_hat_m": 0.005,
        "stiffness_policy": {{"name": "fixed", "kappa_N_per_m": 50}}}},
        "time": {{"dt_s": 0.01, "steps": {}}}, "scene": {{"name": "bodies", "bodies": [{},
          {{"name": "free", "mesh": {{"generator": "grid", "n_x": 2, "n_y": 2, "size_x_m": 1, "size_y_m": 1}},
            "transform": {{"translate_m": [0, 0, 9]}}, {}}}]}}}})",
                  steps, bodies, material),
      "test");
}

/// A given sheet of 2 x 2 squares in the plane z = 0.5, and one of 2 x 2 that stands upright, `up` m higher than half way
/// through the first.
RunConfig given_sheets(double up) {
  return config_of(
      fmt::format(
          R"({{"name": "a", "mesh": {{"generator": "grid", "n_x": 3, "n_y": 3, "size_x_m": 1, "size_y_m": 1}},
      "transform": {{"translate_m": [0, 0, 0.5]}}, {0}, "pins": [{{"all": true}}]}},
    {{"name": "b", "mesh": {{"generator": "grid", "n_x": 3, "n_y": 3, "size_x_m": 0.5, "size_y_m": 0.5}},
      "transform": {{"axis": [1, 0, 0], "angle_deg": 90, "translate_m": [0.1, 0.07, {1}]}}, {0}, "pins": [{{"all": true}}]}})",
          material, 0.5 + up),
      3);
}

std::optional<Verdict> failure(const RunConfig& config, const RunLimits& limits = {}) {
  const Scene scene = build_scene(config);
  return start_failure(config, scene, plan_of(config, scene).contacts, limits);
}

int asked_to_stop, stop_at;

TEST(StartCheck, AStopIsHeardBetweenAllPartsOfWhatComesBeforeTheFirstStep) {
  const RunConfig config = given_sheets(1);
  const auto all_of_it = [&config] {
    const Scene scene = build_scene(config);
    const Plan plan = plan_of(config, scene);
    EXPECT_FALSE(start_failure(config, scene, plan.contacts));
  };
  asked_to_stop = 0, stop_at = 0;
  set_stop_request([] {
    if (++asked_to_stop == stop_at) throw Interrupted{};
  });
  all_of_it();
  const int parts = asked_to_stop;
  EXPECT_GE(parts, 7);  // two bodies, the scene, the audit in three parts, the surface
  for (stop_at = 1; stop_at <= parts; ++stop_at) {
    asked_to_stop = 0;
    EXPECT_THROW(all_of_it(), Interrupted) << stop_at;
  }
  set_stop_request(nullptr);
}

TEST(StartCheck, AStopCutsNoStepInWhoseMiddleItIsHeard) {
  RunConfig config = given_sheets(1);
  config.passes = {false, false, true};  // the audit of each state looks for stops
  const Scene scene = build_scene(config);
  const Plan plan = plan_of(config, scene);
  RunRecord record;
  Recorder recorder(config, scene, record, nullptr);
  const RunOptions options;
  Pass pass(config, scene, {}, plan, options, "audit", recorder);
  set_stop_request([] { throw Interrupted{}; });
  EXPECT_THROW(heed_stop(), Interrupted);
  PassResult result;
  EXPECT_NO_THROW(result = pass.run([](Pass::Moment) {}));
  EXPECT_THROW(heed_stop(), Interrupted) << "after the steps it is heard again";
  set_stop_request(nullptr);
  EXPECT_EQ(result.steps.size(), static_cast<std::size_t>(config.time.steps));
  EXPECT_GT(record.audit.states, 0) << "nothing was audited";
}

TEST(StartCheck, GivenSheetsThatPassThroughEachOtherAreNamedWhateverTheirPosition) {
  for (const double up : {0.0, 0.03, 0.1, -0.24}) {
    const auto found = failure(given_sheets(up));
    ASSERT_TRUE(found) << up;
    EXPECT_EQ(found->outcome, Outcome::given_parts_cross) << up;
    for (const char* word : {"a[", "b[", "crosses", "prescribed"}) {
      EXPECT_NE(found->detail.find(word), std::string::npos) << found->detail;
    }
  }
  EXPECT_FALSE(failure(given_sheets(0.25))) << "it stands on the other";
  EXPECT_FALSE(failure(given_sheets(-0.25))) << "it hangs from the other";
  EXPECT_FALSE(failure(given_sheets(0.3)));
}

/// A ball beside a given sheet, moving sideways at 1 m/s and turning.
std::string driven_ball(int level) {
  return fmt::format(
      R"({{"name": "sheet", "mesh": {{"generator": "grid", "n_x": 3, "n_y": 3, "size_x_m": 0.5, "size_y_m": 0.5}},
      "transform": {{"axis": [0, 1, 0], "angle_deg": 90}}, {1}, "pins": [{{"all": true}}]}},
    {{"name": "ball", "kind": "rigid", "mesh": {{"generator": "icosphere", "level": {0}, "radius_m": 0.1}},
      "transform": {{"translate_m": [-0.25, 0, 0]}},
      "motion": {{"velocity_m_per_s": [1, 0, 0], "angular_velocity_rad_per_s": 1, "center_m": [-0.25, 0, 0]}}}})",
      level, material);
}

TEST(StartCheck, GivenMotionsAreFollowedAsFarAsTheRunGoes) {
  EXPECT_FALSE(failure(config_of(driven_ball(1), 14)));
  const auto found = failure(config_of(driven_ball(1), 40));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->outcome, Outcome::given_parts_cross);
  EXPECT_NE(found->detail.find("ball["), std::string::npos) << found->detail;
  EXPECT_NE(found->detail.find("sheet["), std::string::npos) << found->detail;
}

/// One prescribed body alone, which an obstacle is in the way of, or which moves away from it.
TEST(StartCheck, APrescribedBodyThatIsDrivenIntoAnObstacleIsRefused) {
  const auto driven = [](double speed, const std::string& obstacles) {
    const RunConfig config = config_of(
        fmt::format(
            R"({{"name": "ball", "kind": "rigid", "mesh": {{"generator": "icosphere", "level": 1, "radius_m": 0.1}},
              "transform": {{"translate_m": [0, 0, 0.25]}}, "motion": {{"velocity_m_per_s": [0, 0, {}]}}}})",
            speed),
        20);
    const std::vector<std::string> set = {"/scene/obstacles=" + obstacles};
    return failure(parse_config(resolved_json(config), "test", ".", set));
  };
  constexpr const char* floor = R"([{"name": "floor", "kind": "plane", "axis": [0, 0, 1]}])";
  const auto found = driven(-1, floor);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->outcome, Outcome::given_parts_cross);
  EXPECT_NE(found->detail.find("ball["), std::string::npos) << found->detail;
  EXPECT_NE(found->detail.find("floor"), std::string::npos) << found->detail;
  EXPECT_FALSE(driven(1, floor)) << "it rises";
  EXPECT_FALSE(driven(-0.7, floor)) << "it stops 1 cm above the floor";
  EXPECT_TRUE(driven(-0.95, floor)) << "it goes 4 cm into the floor";
  EXPECT_FALSE(driven(0, floor)) << "it stays";
  EXPECT_FALSE(driven(-1, "[]")) << "nothing is in its way";
}

TEST(StartCheck, ATimeLimitEndsItAndSaysWhere) {
  const RunConfig turning = config_of(
      R"({"name": "ball", "kind": "rigid", "mesh": {"generator": "icosphere", "level": 1, "radius_m": 0.1},
          "motion": {"angular_velocity_rad_per_s": 1}},
         {"name": "other", "kind": "rigid", "mesh": {"generator": "icosphere", "level": 1, "radius_m": 0.1},
          "transform": {"translate_m": [1, 0, 0]}})",
      10000000);
  const double begin = now_s();
  const auto late = failure(turning, {nullptr, begin + 0.2, 0.2});
  EXPECT_LT(now_s() - begin, 5);
  ASSERT_TRUE(late);
  EXPECT_EQ(late->outcome, Outcome::timeout);
  EXPECT_NE(late->detail.find("limit of 0.2 s was reached in the prescribed motions, at step "),
            std::string::npos)
      << late->detail;
  EXPECT_EQ(late->detail.find("at step 0 of"), std::string::npos) << late->detail;
  const auto at_once = failure(turning, {nullptr, begin, 0.2});
  ASSERT_TRUE(at_once);
  EXPECT_NE(at_once->detail.find("before the start was looked at"), std::string::npos) << at_once->detail;
}

TEST(StartCheck, TheRecordHasItsOutcomeAndItsSeconds) {
  const test::TemporaryFolder folder;
  RunOptions options;
  options.folder = folder;
  options.time_limit_s = 1e-9;
  RunRecord record = run_config(given_sheets(0.3), options);
  EXPECT_EQ(record.status.outcome, Outcome::timeout);
  EXPECT_NE(record.status.detail.find("start check"), std::string::npos) << record.status.detail;
  EXPECT_TRUE(record.steps.empty());
  EXPECT_FALSE(record.status.valid);
  EXPECT_TRUE(std::filesystem::exists(folder / "run.json"));
  options.time_limit_s = 0;
  record = run_config(given_sheets(0.3), options);
  EXPECT_EQ(record.steps.size(), 3U);
  EXPECT_GT(record.summary.start_check_s, 0);
  EXPECT_LT(record.summary.start_check_s, 5);
}

}  // namespace
}  // namespace bb::start_check_test
