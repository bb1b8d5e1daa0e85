// Collision kinds and groups: what a config states of them, and what it may not.
#include "tests/config/config_text.hpp"

namespace bb::test::collision_settings_test {
namespace {

/// A square that is pinned over a ball, both given as bodies, and a floor.
json three_kinds() {
  json config = bodies_config();
  config["scene"]["bodies"].push_back(
      {{"name", "ball"},
       {"mesh", {{"generator", "icosphere"}, {"level", 1}, {"radius_m", 0.2}}},
       {"transform", {{"translate_m", {0, 0, -1}}}}});
  config["scene"]["obstacles"] = {{{"name", "floor"}, {"kind", "plane"}, {"point_m", {0, 0, -5}}}};
  return config;
}

std::string refusal(const json& config) {
  try {
    build_scene(parsed(config));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(CollisionSettings, AreWrittenAndReadAgain) {
  json config = three_kinds();
  config["scene"]["collisions"] = {{{"a", "ball"}, {"b", "cloth"}, {"kind", "auto"}},
                                   {{"a", "floor"}, {"b", "ball"}, {"kind", "static"}},
                                   {{"a", "ball"}, {"b", "ball"}, {"kind", "off"}}};
  config["scene"]["bodies"][1]["collision_group"] = "solids";
  config["scene"]["obstacles"][0]["collision_group"] = "others";
  const RunConfig read = parsed(config);
  const json resolved = json::parse(resolved_json(read));
  EXPECT_EQ(resolved["scene"]["collisions"], config["scene"]["collisions"]);
  EXPECT_EQ(json::parse(resolved_json(parsed(resolved))), resolved);
  const Collisions of = build_scene(read).collisions;
  EXPECT_EQ(of.kind(0, 1), CollisionKind::audited) << "open";
  EXPECT_EQ(of.kind(1, 2), CollisionKind::static_test) << "though the groups differ";
  EXPECT_EQ(of.kind(1, 1), CollisionKind::off);
  EXPECT_EQ(of.kind(0, 0), CollisionKind::ccd) << "is not named";
  EXPECT_EQ(of.kind(0, 2), CollisionKind::ccd) << "the cloth is of no group";
}

TEST(CollisionSettings, ThatAreAbsentAreNotWritten) {
  const json scene = json::parse(resolved_json(parsed(three_kinds())))["scene"];
  EXPECT_FALSE(scene.contains("collisions"));
  EXPECT_FALSE(scene["bodies"][0].contains("collision_group"));
  EXPECT_FALSE(scene["obstacles"][0].contains("collision_group"));
  EXPECT_FALSE(build_scene(parsed(three_kinds())).collisions.chosen());
}

TEST(CollisionSettings, NameWhatIsThere) {
  json config = three_kinds();
  json& pair = config["scene"]["collisions"][0];
  pair = {{"a", "ball"}, {"b", "clot"}, {"kind", "off"}};
  for (const char* part : {"a.json#/scene/collisions/0/b", "clot", "cloth, ball, floor"}) {
    EXPECT_NE(refusal(config).find(part), std::string::npos) << refusal(config);
  }
  pair = {{"a", "ball"}, {"b", "cloth"}, {"kind", "of"}};
  expect_violation(config, "/scene/collisions/0/kind", "\"of\"",
                   "auto, ccd, audited, static, proximity, off");
  pair = {{"a", "floor"}, {"b", "floor"}, {"kind", "off"}};
  EXPECT_NE(refusal(config).find("a vertex that moves freely"), std::string::npos) << refusal(config);
  pair = {{"a", "ball"}, {"b", "cloth"}, {"kind", "off"}};
  config["scene"]["collisions"].push_back({{"a", "cloth"}, {"b", "ball"}, {"kind", "ccd"}});
  for (const char* part : {"a.json#/scene/collisions/1", "cloth and ball once more", "every pair once"}) {
    EXPECT_NE(refusal(config).find(part), std::string::npos) << refusal(config);
  }
}

TEST(CollisionSettings, AreNotAuditedWhereTheStepSolverBoundsNoMotion) {
  json config = three_kinds();
  config["scene"]["collisions"] = {{{"a", "ball"}, {"b", "cloth"}, {"kind", "audited"}}};
  EXPECT_EQ(refusal(config), "");
  config["step_solver"] = {{"name", "pncg"}};
  EXPECT_EQ(refusal(config), "");
  config["step_solver"]["pncg_bound"] = "half_d_hat";
  for (const char* part :
       {"a.json#/scene/collisions/0/kind", "audited", "the step solver pncg bounds no motion"}) {
    EXPECT_NE(refusal(config).find(part), std::string::npos) << refusal(config);
  }
  config["scene"]["collisions"][0]["kind"] = "auto";
  EXPECT_EQ(build_scene(parsed(config)).collisions.kind(0, 1), CollisionKind::ccd);
}

TEST(CollisionSettings, AreRefusedOnADevice) {
  json config = three_kinds();
  config["scene"]["collisions"] = {{{"a", "ball"}, {"b", "cloth"}, {"kind", "off"}}};
  config["scene"]["bodies"][0]["collision_group"] = "one";
  config["device"] = "host";
  std::vector<std::string> places;
  for (const Violation& v : violations_of(config.dump())) places.push_back(v.where);
  for (const char* place : {"a.json#/scene/collisions", "a.json#/scene/bodies/0/collision_group"}) {
    EXPECT_NE(std::find(places.begin(), places.end(), place), places.end()) << place;
  }
}

}  // namespace
}  // namespace bb::test::collision_settings_test
