// The file of what is judged: edges that it makes, and what it refuses with its place.
#include "experiments/judge/subject.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/math/error.hpp"
#include "tests/temporary_folder.hpp"

namespace bb::judge::subject_test {
namespace {

using nlohmann::json;

json two_triangles_and_a_rod() {
  return {{"schema", subject_schema},
          {"n_vertices", 7},
          {"reach_m", 0.5},
          {"bodies", {{{"name", "sheet"}, {"first_vertex", 0}}, {{"name", "rod"}, {"first_vertex", 4}}}},
          {"triangles", {{0, 1, 2}, {1, 3, 2}}},
          {"segments", {{5, 4}}},
          {"given", {3}},
          {"half_thickness_m", {0.1, 0.1, 0.1, 0.1, 0.2, 0.2, 0}},
          {"obstacles", {{{"kind", "sphere"}, {"radius_m", 2}, {"inside", true}}}}};
}

Subject read(const json& document) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "subject.json") << document.dump();
  return read_subject(folder / "subject.json");
}

/// The pointer at which a document is refused; empty: it is not.
std::string refused_at(const json& document) {
  try {
    read(document);
  } catch (const ConfigError& error) {
    const std::string& where = error.violations().front().where;
    EXPECT_FALSE(error.violations().front().allowed.empty());
    return where.find('#') == std::string::npos ? "file" : where.substr(where.find('#') + 1);
  }
  return {};
}

TEST(Subject, has_every_edge_once_and_particles) {
  const Subject found = read(two_triangles_and_a_rod());
  ASSERT_EQ(found.mesh.edges.cols(), 6) << "five sides of two triangles, one of them shared, and a rod";
  EXPECT_EQ(found.mesh.edges.col(5), Eigen::Vector2i(4, 5));
  EXPECT_EQ(found.mesh.points, std::vector<int>{6});
  EXPECT_TRUE(found.mesh.is_prescribed(3));
  EXPECT_FALSE(found.mesh.is_prescribed(2));
  EXPECT_EQ(found.mesh.thickness[4], 0.2);
  EXPECT_TRUE(found.mesh.obstacles[0].inside);
  EXPECT_EQ(found.names.obstacles, std::vector<std::string>{"sphere 0"});
  EXPECT_EQ(found.names.vertices(std::array{5, 4}), "rod[1 0]");
}

TEST(Subject, planar_edges_are_those_of_one_triangle) {
  json document = two_triangles_and_a_rod();
  document["planar"] = true;
  const Subject found = read(document);
  ASSERT_EQ(found.mesh.edges.cols(), 5);
  EXPECT_EQ(found.mesh.opposite.back(), -1) << "of the rod";
  EXPECT_EQ(found.mesh.opposite.front(), 2) << "of the side 0 1";
}

TEST(Subject, a_vertex_that_an_obstacle_moves_with_is_no_particle) {
  json document = two_triangles_and_a_rod();
  document["obstacles"][0]["vertex"] = 6;
  const Subject found = read(document);
  EXPECT_TRUE(found.mesh.points.empty());
  EXPECT_TRUE(found.mesh.is_prescribed(6));
  EXPECT_EQ(found.mesh.obstacles[0].vertex, 6);
}

TEST(Subject, refusals_name_their_place) {
  const auto changed = [](const char* pointer, const json& value) {
    json document = two_triangles_and_a_rod();
    document[json::json_pointer(pointer)] = value;
    return refused_at(document);
  };
  EXPECT_EQ(refused_at(two_triangles_and_a_rod()), "");
  EXPECT_EQ(changed("/schema", "barrierbench.subject/2"), "/schema");
  EXPECT_EQ(changed("/n_vertices", 0), "/n_vertices");
  EXPECT_EQ(changed("/triangles/1/2", 7), "/triangles/1");
  EXPECT_EQ(changed("/triangles/1", json{1, 1, 2}), "/triangles/1");
  EXPECT_EQ(changed("/segments/0", json{4}), "/segments/0");
  EXPECT_EQ(changed("/bodies/1/first_vertex", 0), "/bodies/1/first_vertex");
  EXPECT_EQ(changed("/bodies/0/first_vertex", 1), "/bodies/0/first_vertex");
  EXPECT_EQ(changed("/obstacles/0/kind", "torus"), "/obstacles/0/kind");
  EXPECT_EQ(changed("/obstacles/0/radius_m", 0), "/obstacles/0/radius_m");
  EXPECT_EQ(changed("/obstacles/0/axis", json{0, 0, 0}), "/obstacles/0/axis");
  EXPECT_EQ(changed("/given/0", 9), "/given/0");
  EXPECT_EQ(changed("/half_thickness_m", json{0.1}), "/half_thickness_m");
  EXPECT_EQ(changed("/half_thickness_m/2", -1), "/half_thickness_m/2");
  EXPECT_EQ(changed("/reach_m", "far"), "/reach_m");
  EXPECT_EQ(changed("/colour", 3), "/colour");
  json nothing = two_triangles_and_a_rod();
  nothing.erase("triangles"), nothing.erase("segments"), nothing.erase("obstacles");
  EXPECT_EQ(refused_at(nothing), "file");
}

}  // namespace
}  // namespace bb::judge::subject_test
