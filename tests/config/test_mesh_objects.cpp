// A body of some objects of an OBJ, and pins of the vertices of an object; unknown names are refused with their place.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/math/error.hpp"
#include "experiments/config/parse.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::mesh_objects_test {
namespace {

using nlohmann::json;

/// Two squares side by side that share an edge, in a file that goes when the test ends.
class MeshObjectsOfABody : public ::testing::Test {
 protected:
  MeshObjectsOfABody() {
    std::ofstream(file_) << "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\n"
                            "o left\nf 1 2 5 4\no right\nf 2 3 6 5\ng edge\nl 3 6\n";
  }

  json mesh_of(const std::vector<std::string>& objects) const {
    json mesh = {{"file", file_.string()}};
    if (!objects.empty()) mesh["objects"] = objects;
    return mesh;
  }

  static RunConfig config_of(const json& body) {
    json config = {{"schema", "barrierbench.config/1"}, {"formulation", {{"d_hat_m", 1e-3}}}};
    config["time"] = {{"dt_s", 0.01}, {"steps", 1}};
    config["scene"]["bodies"] = json::array({body});
    config["scene"]["bodies"][0]["name"] = "body";
    return parse_config(config.dump(), "test");
  }

  static std::string refused(const json& body) {
    try {
      build_scene(config_of(body));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  }

  static std::vector<int> pinned(const Scene& scene) {
    std::vector<int> out;
    for (const Pin& pin : scene.pins) out.push_back(pin.vertex);
    return out;
  }

  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_ / "squares.obj";
};

TEST_F(MeshObjectsOfABody, AreItsMesh) {
  const Scene whole = build_scene(config_of({{"mesh", mesh_of({})}}));
  EXPECT_EQ(whole.n_vertices(), 6);
  const RunConfig config = config_of({{"mesh", mesh_of({"right"})}});
  const Scene right = build_scene(config);
  ASSERT_EQ(right.n_vertices(), 4);
  EXPECT_EQ(right.x0.col(0), Vec3d(1, 0, 0));
  EXPECT_EQ(right.surface_triangles.size(), 2u);

  const std::string text = resolved_json(config);
  EXPECT_NE(text.find("\"objects\""), std::string::npos);
  EXPECT_EQ(resolved_json(parse_config(text, "test")), text);
  EXPECT_NE(config_id(config), config_id(config_of({{"mesh", mesh_of({"left"})}})));
  EXPECT_EQ(resolved_json(config_of({{"mesh", mesh_of({})}})).find("\"objects\""), std::string::npos);
}

TEST_F(MeshObjectsOfABody, ArePinned) {
  json body = {{"mesh", mesh_of({})}, {"pins", json::array({{{"objects", {"left"}}}})}};
  EXPECT_EQ(pinned(build_scene(config_of(body))), (std::vector<int>{0, 1, 3, 4}));
  body["pins"][0]["indices"] = {2};
  EXPECT_EQ(pinned(build_scene(config_of(body))), (std::vector<int>{0, 1, 2, 3, 4}));
  const std::string text = resolved_json(config_of(body));
  EXPECT_EQ(pinned(build_scene(parse_config(text, "test"))), (std::vector<int>{0, 1, 2, 3, 4}));
  body["mesh"] = mesh_of({"right", "edge"});
  body["pins"] = json::array({{{"objects", {"edge"}}}});
  EXPECT_EQ(pinned(build_scene(config_of(body))), (std::vector<int>{1, 3}));  // numbered anew
}

TEST_F(MeshObjectsOfABody, ArePinnedWhereThePartThatTheBodyTakesHasTheirVertices) {
  json body = {{"mesh", mesh_of({"right"})}, {"pins", json::array({{{"objects", {"left"}}}})}};
  EXPECT_EQ(pinned(build_scene(config_of(body))), (std::vector<int>{0, 2}));  // of the edge that both have
  body["mesh"] = mesh_of({"left"});
  body["pins"][0]["objects"] = {"edge"};
  EXPECT_EQ(refused(body), "test#/scene/bodies/0/pins/0/objects/0: found \"edge\", an object of " +
                               file_.string() +
                               " of which the body has no vertex; allowed: an object that has vertices in "
                               "common with those of mesh/objects: left");
}

TEST_F(MeshObjectsOfABody, AreRefusedWhereTheFileHasNoSuchName) {
  const std::string names = "; allowed: one of left, right, edge";
  EXPECT_EQ(refused({{"mesh", mesh_of({"left", "up"})}}),
            "test#/scene/bodies/0/mesh/objects/1: found \"up\", which no face or line of " + file_.string() +
                " has" + names);
  EXPECT_EQ(refused({{"mesh", mesh_of({})}, {"pins", json::array({{{"objects", {"left", "Left"}}}})}}),
            "test#/scene/bodies/0/pins/0/objects/1: found \"Left\", which no face or line of " +
                file_.string() + " has" + names);
  const json grid = {{"generator", "grid"}, {"n_x", 3}, {"n_y", 3}};
  const std::string no_names = refused({{"mesh", grid}, {"pins", json::array({{{"objects", {"left"}}}})}});
  EXPECT_NE(no_names.find("which no face or line of the mesh has; allowed: a mesh file with objects"),
            std::string::npos)
      << no_names;
}

TEST_F(MeshObjectsOfABody, AreAListOfTextsAndOfAFileAlone) {
  for (const json& wrong : {json("left"), json::array(), json::array({""}), json::array({1})}) {
    json mesh = mesh_of({});
    mesh["objects"] = wrong;
    EXPECT_NE(refused({{"mesh", mesh}}).find("/mesh/objects"), std::string::npos) << wrong;
  }
  const json grid = {{"generator", "grid"}, {"n_x", 3}, {"n_y", 3}, {"objects", {"left"}}};
  EXPECT_NE(refused({{"mesh", grid}}).find("the unknown key \"objects\""), std::string::npos);
}

}  // namespace
}  // namespace bb::mesh_objects_test
