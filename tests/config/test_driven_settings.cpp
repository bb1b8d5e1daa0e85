// Motions, pulls, obstacles that move, gravity and wind over time: what a config says of them, and what it may not.
#include "tests/config/config_text.hpp"

namespace bb::test::driven_settings_test {
namespace {

constexpr const char* motion = "/scene/bodies/0/pins/0/motion";

json with_obstacle(const json& obstacle_motion, const char* kind = "sphere") {
  json config = bodies_config();
  json obstacle = {{"name", "ball"}, {"kind", kind}, {"point_m", {0, 0, -3}}, {"motion", obstacle_motion}};
  if (obstacle["kind"] != "plane") obstacle["radius_m"] = 0.5;
  config["scene"]["obstacles"] = {obstacle};
  return config;
}

TEST(DrivenSettings, AreWrittenAndReadAgain) {
  json config = with_obstacle({{"velocity_m_per_s", {1, 0, 0}}, {"end_s", 2}, {"smooth", true}});
  json& pin = config["scene"]["bodies"][0]["pins"][0];
  pin["pull_N_per_m"] = 30;
  pin["pull_factors"] = {{{"time_s", 0}, {"factor", 1}}, {{"time_s", 1}, {"factor", 0}}};
  pin["motion"] = {
      {"angular_velocity_rad_per_s", 2},
      {"then", {{{"keyframes", {{{"time_s", 0}}, {{"time_s", 1}, {"translate_m", {0, 0, 1}}}}}}}}};
  config["scene"]["gravity_schedule"] = {{{"time_s", 0}, {"gravity_m_per_s2", {0, 0, -9}}},
                                         {{"time_s", 1}, {"gravity_m_per_s2", {0, 0, 9}}}};
  config["scene"]["air"] = {{"normal_N_s_per_m3", 0.5}, {"wind_m_per_s", {1, 0, 0}}};
  const RunConfig read = parsed(config);
  EXPECT_EQ(read.scene.gravity, Vec3d(0, 0, -9));
  const json resolved = json::parse(resolved_json(read));
  EXPECT_EQ(json::parse(resolved_json(parsed(resolved))), resolved);
  EXPECT_EQ(resolved["scene"]["bodies"][0]["pins"][0]["motion"]["then"][0]["keyframes"].size(), 2U);
  const Scene scene = build_scene(read);
  ASSERT_EQ(scene.pulls.size(), 1U);
  EXPECT_EQ(scene.pulls[0].vertices, (std::vector<int>{2, 3}));
  EXPECT_EQ(scene.pulls[0].factors.size(), 2U);
  ASSERT_EQ(scene.obstacles[0].vertex, 4);
  EXPECT_EQ(scene.n_vertices(), 5);
  EXPECT_EQ(pin_pose(scene, scene.pins[0], 2), Vec3d(2, 0, -3));
  EXPECT_EQ(scene.air.normal, 0.5);
}

TEST(DrivenSettings, ThatAreAbsentAreNotWritten) {
  const json resolved = json::parse(resolved_json(parsed(with_obstacle(json::object()))))["scene"];
  EXPECT_FALSE(resolved["obstacles"][0].contains("motion"));
  EXPECT_FALSE(resolved.contains("air"));
  EXPECT_FALSE(resolved.contains("gravity_schedule"));
  for (const char* key : {"then", "keyframes", "scale", "smooth"}) {
    EXPECT_FALSE(resolved["bodies"][0]["pins"][0]["motion"].contains(key)) << key;
  }
}

TEST(DrivenSettings, TimesIncrease) {
  json config = bodies_config();
  json& pin = config["scene"]["bodies"][0]["pins"][0];
  pin["motion"] = {{"keyframes", {{{"time_s", 1}}, {{"time_s", 0.5}}}}};
  expect_violation(config, std::string(motion) + "/keyframes/1/time_s", "0.5",
                   "a number > 1, the time before");
  pin["motion"] = {{"then", {{{"start_s", 2}, {"end_s", 1}}}}};
  expect_violation(config, std::string(motion) + "/then/0/end_s", "1", "a number >= 2");
  pin.erase("motion");
  pin["pull_N_per_m"] = 3;
  pin["pull_factors"] = {{{"time_s", 1}, {"factor", 1}}, {{"time_s", 1}, {"factor", 0}}};
  expect_violation(config, "/scene/bodies/0/pins/0/pull_factors/1/time_s", "1", "a number > 1");
  config = bodies_config();
  config["scene"]["gravity_schedule"] = {{{"time_s", 1}, {"gravity_m_per_s2", {0, 0, -9}}},
                                         {{"time_s", 0}, {"gravity_m_per_s2", {0, 0, 9}}}};
  expect_violation(config, "/scene/gravity_schedule/1/time_s", "0", "a number > 1");
}

TEST(DrivenSettings, ThatContradictEachOtherAreRefused) {
  json config = bodies_config();
  json& pin = config["scene"]["bodies"][0]["pins"][0];
  pin["motion"] = {{"velocity_m_per_s", {1, 0, 0}}, {"keyframes", {{{"time_s", 1}}}}};
  expect_violation(config, motion, "rates or a scale beside keyframes", "one of both");
  pin["motion"] = {{"scale", 2}};
  expect_violation(config, std::string(motion) + "/end_s", "nothing", "scale and smooth need one");
  pin["motion"] = {{"smooth", true}, {"start_s", 1}, {"end_s", 1}};
  expect_violation(config, std::string(motion) + "/end_s", "1", "a number > 1");
  pin.erase("motion");
  pin["pull_factors"] = {{{"time_s", 1}, {"factor", 1}}};
  expect_violation(config, "/scene/bodies/0/pins/0/pull_factors", "factors of no pull", "pull_N_per_m");
  config = bodies_config();
  config["scene"]["gravity_m_per_s2"] = {0, 0, -9};
  config["scene"]["gravity_schedule"] = {{{"time_s", 1}, {"gravity_m_per_s2", {0, 0, -9}}}};
  expect_violation(config, "/scene/gravity_m_per_s2", "[0,0,-9]", "nothing beside gravity_schedule");
  config = bodies_config();
  config["scene"]["air"] = {{"wind_m_per_s", {1, 0, 0}},
                            {"wind_schedule", {{{"time_s", 1}, {"wind_m_per_s", {0, 0, -9}}}}}};
  expect_violation(config, "/scene/air/wind_m_per_s", "a wind beside wind_schedule", "one of both");
}

TEST(DrivenSettings, ObstaclesKeepTheirSizeAndTheirAxis) {
  const auto refused = [](const json& config) -> std::string {
    try {
      build_scene(parsed(config));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  };
  const json turn = {{"axis", {1, 0, 0}}, {"angular_velocity_rad_per_s", 1}};
  EXPECT_EQ(refused(with_obstacle(turn)), "") << "a ball turns as it likes";
  EXPECT_NE(refused(with_obstacle(turn, "plane")).find("a rotation about the plane's normal"),
            std::string::npos);
  EXPECT_NE(refused(with_obstacle(turn, "cylinder")).find("the direction of the cylinder's axis"),
            std::string::npos);
  const json about_z = {{"angular_velocity_rad_per_s", 1}};
  EXPECT_EQ(refused(with_obstacle(about_z, "plane")), "");
  EXPECT_EQ(refused(with_obstacle(about_z, "cylinder")), "");
  EXPECT_NE(refused(with_obstacle({{"scale", 2}, {"end_s", 1}})).find("obstacles keep their size"),
            std::string::npos);
}

TEST(DrivenSettings, ADeviceKnowsNeitherObstaclesThatMoveNorGravityOverTime) {
  json config = with_obstacle({{"velocity_m_per_s", {1, 0, 0}}});
  config["device"] = "host";
  config["linear_solver"] = {{"name", "pcg_resident"}};
  expect_violation(config, "/scene/obstacles/0/motion", "an obstacle that moves",
                   "no motion with device host");
  config["scene"].erase("obstacles");
  config["scene"]["gravity_schedule"] = {{{"time_s", 1}, {"gravity_m_per_s2", {0, 0, -9}}}};
  expect_violation(config, "/scene/gravity_schedule", "gravity over time",
                   "gravity_m_per_s2 with device host");
}

}  // namespace
}  // namespace bb::test::driven_settings_test
