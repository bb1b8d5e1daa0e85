// A rest shape from another mesh of the same elements; meshes of other elements are refused with what differs.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/math/error.hpp"
#include "experiments/config/parse.hpp"

namespace bb::rest_mesh_test {
namespace {

using nlohmann::json;

json grid(int n_x, double size_x) {
  return {{"generator", "grid"}, {"n_x", n_x}, {"n_y", 3}, {"size_x_m", size_x}};
}

RunConfig config_of(const json& body) {
  json config = {{"schema", "barrierbench.config/1"}, {"formulation", {{"d_hat_m", 1e-3}}}};
  config["time"] = {{"dt_s", 0.01}, {"steps", 1}};
  config["scene"]["bodies"] = json::array({body});
  return parse_config(config.dump(), "test");
}
json body_of(const json& mesh, const json& rest) {
  return {{"name", "body"}, {"mesh", mesh}, {"rest_mesh", rest}};
}

std::string refused(const json& body) {
  try {
    build_scene(config_of(body));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(RestMesh, IsTheRestShapeAndTheMeshWhereTheBodyStarts) {
  json body = body_of(grid(4, 1.0), grid(4, 1.5));
  body["transform"] = {{"scale", 2.0}, {"translate_m", {0, 0, 1}}};
  const Scene both = build_scene(config_of(body));
  body.erase("rest_mesh");
  const Scene started = build_scene(config_of(body));
  body["mesh"] = grid(4, 1.5);
  const Scene rested = build_scene(config_of(body));
  EXPECT_EQ(both.x0, started.x0);
  EXPECT_EQ(both.rest, rested.rest);
  EXPECT_EQ(both.mass, rested.mass);  // that of the rest shape
  EXPECT_GT((both.rest - both.x0).norm(), 0.1);
  EXPECT_EQ(resolved_json(config_of(body)).find("rest_mesh"), std::string::npos);
  body["rest_mesh"] = grid(4, 1.0);
  const std::string text = resolved_json(config_of(body));
  EXPECT_NE(text.find("rest_mesh"), std::string::npos);
  EXPECT_EQ(resolved_json(parse_config(text, "test")), text);
}

TEST(RestMesh, IsRefusedWithOtherElements) {
  const std::string fewer = refused(body_of(grid(4, 1), grid(5, 1)));
  EXPECT_NE(fewer.find("test#/scene/bodies/0/rest_mesh: found 15 vertices; allowed: 12"), std::string::npos)
      << fewer;
  json turned = {{"generator", "grid"}, {"n_x", 3}, {"n_y", 4}};
  const std::string other = refused(body_of(grid(4, 1), turned));
  EXPECT_NE(other.find("found triangles 0 of other vertices"), std::string::npos) << other;
  json rod = {{"generator", "rod"}, {"n_segments", 11}};
  const std::string none = refused(body_of(grid(4, 1), rod));
  EXPECT_NE(none.find("/rest_mesh"), std::string::npos) << none;
}

TEST(RestMesh, IsNothingForARigidBody) {
  json body = body_of(grid(4, 1), grid(4, 2));
  body["kind"] = "rigid";
  EXPECT_NE(refused(body).find("/scene/bodies/0/rest_mesh: found rest_mesh of a rigid body"),
            std::string::npos)
      << refused(body);
}

}  // namespace
}  // namespace bb::rest_mesh_test
