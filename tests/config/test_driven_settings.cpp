// Motions, pulls, obstacles that move, gravity and wind over time: what a config states of them, and what it may not.
#include "tests/config/config_text.hpp"

namespace bb::test::driven_settings_test {
namespace {

constexpr const char* motion = "/scene/bodies/0/pins/0/motion";

/// One square whose two upper vertices are pinned.
json driven_config() {
  json config = bodies_config();
  config["scene"]["bodies"][0]["pins"] = {{{"indices", {2, 3}}}};
  return config;
}

json with_obstacle(const json& obstacle_motion, const char* kind = "sphere") {
  json config = driven_config();
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
  json config = driven_config();
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
  config = driven_config();
  config["scene"]["gravity_schedule"] = {{{"time_s", 1}, {"gravity_m_per_s2", {0, 0, -9}}},
                                         {{"time_s", 0}, {"gravity_m_per_s2", {0, 0, 9}}}};
  expect_violation(config, "/scene/gravity_schedule/1/time_s", "0", "a number > 1");
}

TEST(DrivenSettings, ThatContradictEachOtherAreRefused) {
  json config = driven_config();
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
  config = driven_config();
  config["scene"]["gravity_m_per_s2"] = {0, 0, -9};
  config["scene"]["gravity_schedule"] = {{{"time_s", 1}, {"gravity_m_per_s2", {0, 0, -9}}}};
  expect_violation(config, "/scene/gravity_m_per_s2", "[0,0,-9]", "nothing beside gravity_schedule");
  config = driven_config();
  config["scene"]["air"] = {{"wind_m_per_s", {1, 0, 0}},
                            {"wind_schedule", {{{"time_s", 1}, {"wind_m_per_s", {0, 0, -9}}}}}};
  expect_violation(config, "/scene/air/wind_m_per_s", "a wind beside wind_schedule", "one of both");
}

/// What building the scene of a config states, which reading it does not refuse.
std::string refusal(const json& config) {
  try {
    build_scene(parsed(config));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(DrivenSettings, PinsAndPullsAreHeldAndReleased) {
  json config = driven_config();
  json& pin = config["scene"]["bodies"][0]["pins"][0];
  EXPECT_TRUE(build_scene(parsed(config)).pins.at(0).span.always());
  pin["release_s"] = 1;
  const Scene pinned = build_scene(parsed(config));
  EXPECT_EQ(pinned.pins.at(1).span.release, 1);
  EXPECT_FALSE(pinned.pins.at(1).span.always());
  EXPECT_GT(pinned.mass[2], 0) << "a vertex that will be free";
  pin["release_s"] = -1;
  EXPECT_TRUE(violations_of(with(config, "/scene/bodies/0/pins/0/hold_s", 0).dump()).size() == 1);
  pin["release_s"] = 1;
  pin["pull_N_per_m"] = 3;
  pin["hold_s"] = 2;
  expect_violation(config, "/scene/bodies/0/pins/0/release_s", "1", "a number > 2, when it begins to hold");
  pin["hold_s"] = 0.5;
  const Scene scene = build_scene(parsed(config));
  EXPECT_EQ(scene.pulls.at(0).span.hold, 0.5);
  EXPECT_EQ(scene.pulls.at(0).span.release, 1);
  const json resolved = json::parse(resolved_json(parsed(config)));
  EXPECT_EQ(json::parse(resolved_json(parsed(resolved))), resolved);
}

TEST(DrivenSettings, WhatIsPrescribedBeginsWhereItIs) {
  json config = driven_config();
  json& pin = config["scene"]["bodies"][0]["pins"][0];
  pin["motion"] = {{"keyframes", {{{"time_s", 0}, {"translate_m", {0, 0, 1}}}, {{"time_s", 1}}}}};
  EXPECT_NE(refusal(config).find("vertices that are prescribed do not jump"), std::string::npos)
      << refusal(config);
  pin["pull_N_per_m"] = 3;
  EXPECT_EQ(refusal(config), "");
  pin.erase("pull_N_per_m");
  pin["motion"]["keyframes"][0]["time_s"] = 0.5;
  EXPECT_NE(refusal(config).find("do not jump"), std::string::npos) << "constant before the first";
}

json stitched_config() {
  json config = driven_config();
  json other = config["scene"]["bodies"][0];
  other["name"] = "patch";
  other["transform"] = {{"translate_m", {0, 0, 1}}};
  config["scene"]["bodies"].push_back(other);
  config["scene"]["stitches"] = {{{"a", "cloth"},
                                  {"a_vertices", {0, 1}},
                                  {"b", "patch"},
                                  {"b_vertices", {0, 1}},
                                  {"stiffness_N_per_m", 9}}};
  return config;
}

TEST(DrivenSettings, StitchesJoinVerticesThatAreThere) {
  json config = stitched_config();
  EXPECT_EQ(build_scene(parsed(config)).stitches.pairs, (std::vector<std::array<int, 2>>{{0, 4}, {1, 5}}));
  const json resolved = json::parse(resolved_json(parsed(config)));
  EXPECT_EQ(json::parse(resolved_json(parsed(resolved))), resolved);
  json& stitch = config["scene"]["stitches"][0];
  const auto expect_refusal = [&](const char* place, const char* found, const char* allowed) {
    const std::string text = refusal(config);
    for (const std::string& part :
         {std::string("a.json#/scene/stitches/0/") + place, std::string(found), std::string(allowed)}) {
      EXPECT_NE(text.find(part), std::string::npos) << part << " is not in " << text;
    }
  };
  stitch["b_vertices"] = {0, 4};
  expect_refusal("b_vertices", "vertex 4", "0 to 3 of body \"patch\"");
  stitch["b_vertices"] = {0};
  expect_refusal("b_vertices", "1 vertices", "as many as a_vertices, 2");
  stitch["b_vertices"] = {0, 1};
  stitch["b"] = "sleeve";
  expect_refusal("b", "sleeve", "the name of a body: cloth, patch");
  stitch["b"] = "cloth";
  expect_refusal("b_vertices/0", "0", "another vertex than that of a");
  stitch["b"] = "patch";
  stitch["a_vertices"] = {2, 1};
  stitch["b_vertices"] = {2, 1};
  expect_refusal("b_vertices/0", "2", "a stitch with a vertex that is not prescribed");
  stitch["stiffness_N_per_m"] = 0;
  expect_violation(config, "/scene/stitches/0/stiffness_N_per_m", "0", "a number >= 1e-36");
}

TEST(DrivenSettings, StitchesBreakAtTheirStrengthTimesTheWeightOfTheirVertex) {
  json config = stitched_config();
  json& stitch = config["scene"]["stitches"][0];
  EXPECT_FALSE(build_scene(parsed(config)).stitches.first_breakable());
  EXPECT_EQ(resolved_json(parsed(config)).find("strength_N"), std::string::npos);
  stitch["strength_N"] = 6;
  EXPECT_EQ(build_scene(parsed(config)).stitches.strength, (std::vector<double>{6, 6}));
  config["scene"]["bodies"][0]["weights"] = {{{"name", "seam"}, {"formula", "x < 0 ? 0.25 : 1"}}};
  stitch["weights"] = "seam";
  EXPECT_EQ(build_scene(parsed(config)).stitches.strength, (std::vector<double>{1.5, 6}));
  const json resolved = json::parse(resolved_json(parsed(config)));
  EXPECT_EQ(resolved["scene"]["stitches"][0]["weights"], "seam");
  EXPECT_EQ(json::parse(resolved_json(parsed(resolved))), resolved);
  const auto expect_refusal = [&](const json& changed, const std::string& said) {
    EXPECT_NE(refusal(changed).find("a.json#/scene/stitches/0/" + said), std::string::npos)
        << said << " is not in " << refusal(changed);
  };
  expect_refusal(with(config, "/scene/stitches/0/weights", "seams"),
                 "weights: found the weight group \"seams\"; allowed: a group of the body: seam");
  expect_refusal(with(config, "/scene/bodies/0/weights/0/formula", "x < 0 ? 1 : 0"),
                 "a_vertices/1: found vertex 1 with a weight of 0 in \"seam\"; allowed: weights > 0");
  expect_violation(with(config, "/scene/stitches/0/strength_N", 0), "/scene/stitches/0/strength_N", "0",
                   "a number >= 1e-36");
  stitch.erase("strength_N");
  expect_refusal(config, "weights: found weights of stitches that do not break; allowed: strength_N beside");
}

TEST(DrivenSettings, DampingIsAPartOfOneAndNotForTwoSteps) {
  json config = driven_config();
  config["scene"]["velocity_damping"] = {{"factor_per_s", 0.2}};
  EXPECT_EQ(build_scene(parsed(config)).damping.factor, 0.2);
  const json resolved = json::parse(resolved_json(parsed(config)));
  EXPECT_EQ(resolved["scene"]["velocity_damping"], json::parse(R"({"factor_per_s": 0.2})"));
  config["integrator"] = {{"name", "bdf2"}};
  expect_violation(config, "/integrator/name", "\"bdf2\"", "/scene/velocity_damping changes its velocities");
  config.erase("integrator");
  config["scene"]["velocity_damping"]["near_obstacles_factor_per_s"] = 0;
  expect_violation(config, "/scene/velocity_damping/near_obstacles_factor_per_s", "0", "> 0");
  config["scene"]["velocity_damping"] = {{"factor_per_s", 1.7e-46}};  // 0.9 a step of 1 ms
  EXPECT_EQ(build_scene(parsed(config)).damping.factor, 1.7e-46);
}

TEST(DrivenSettings, APressureHasAHessianOfItsOwn) {
  json config = driven_config();
  EXPECT_FALSE(json::parse(resolved_json(parsed(config)))["hessian"].contains("inflation"));
  json& body = config["scene"]["bodies"][0];
  EXPECT_FALSE(json::parse(resolved_json(parsed(config)))["scene"]["bodies"][0].contains("pressure_Pa"));
  body["pressure_Pa"] = 5;
  EXPECT_NE(refusal(config).find("does not close"), std::string::npos);
  body["mesh"] = {{"generator", "solid_box"}, {"n_x", 1}, {"n_y", 1}, {"n_z", 1}};
  body["pins"] = json::array();
  EXPECT_EQ(refusal(config), "");
  const json resolved = json::parse(resolved_json(parsed(config)));
  EXPECT_TRUE(resolved["hessian"].contains("inflation"));
  EXPECT_EQ(json::parse(resolved_json(parsed(resolved))), resolved);
}

TEST(DrivenSettings, ADeviceTakesWhatDrivesVertices) {
  json config = with_obstacle({{"velocity_m_per_s", {1, 0, 0}}});
  config["device"] = "host";
  config["linear_solver"] = {{"name", "pcg_resident"}};
  config["friction"] = {{"mu", 0.3}};
  config["scene"]["obstacles"][0]["restitution"] = 0.5;
  config["scene"]["gravity_schedule"] = {{{"time_s", 1}, {"gravity_m_per_s2", {0, 0, -9}}}};
  config["scene"]["air"] = {{"normal_N_s_per_m3", 1}};
  json& pin = config["scene"]["bodies"][0]["pins"][0];
  pin["pull_N_per_m"] = 3;
  pin["release_s"] = 1;
  EXPECT_EQ(refusal(config), "");
  pin.erase("pull_N_per_m");
  EXPECT_EQ(refusal(config), "") << "prescribed for a time";
  config = stitched_config();
  config["device"] = "host";
  config["linear_solver"] = {{"name", "pcg_resident"}};
  EXPECT_EQ(refusal(config), "");
}

TEST(DrivenSettings, ObstaclesKeepTheirSizeAndTheirAxis) {
  const json turn = {{"axis", {1, 0, 0}}, {"angular_velocity_rad_per_s", 1}};
  EXPECT_EQ(refusal(with_obstacle(turn)), "") << "a ball turns as it likes";
  EXPECT_NE(refusal(with_obstacle(turn, "plane")).find("a rotation about the plane's normal"),
            std::string::npos);
  EXPECT_NE(refusal(with_obstacle(turn, "cylinder")).find("the direction of the cylinder's axis"),
            std::string::npos);
  const json about_z = {{"angular_velocity_rad_per_s", 1}};
  EXPECT_EQ(refusal(with_obstacle(about_z, "plane")), "");
  EXPECT_EQ(refusal(with_obstacle(about_z, "cylinder")), "");
  EXPECT_NE(refusal(with_obstacle({{"scale", 2}, {"end_s", 1}})).find("obstacles keep their size"),
            std::string::npos);
}

}  // namespace
}  // namespace bb::test::driven_settings_test
