// Trajectories with a known answer: a leaf that falls into, through or past a cube.
#include "experiments/judge/judge.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/audit/surface_edges.hpp"
#include "core/math/error.hpp"

namespace bb::judge::judge_test {
namespace {

using nlohmann::json;

/// The cube [0, 1]^3 (vertices 0..7) and a triangle "leaf" (8..10).
Subject cube_and_leaf() {
  Subject out;
  out.n_vertices = 11;
  out.reach_m = 0.6;
  const std::vector<audit::TriangleVertices> triangles{{0, 1, 3}, {4, 6, 7}, {0, 4, 5}, {2, 3, 7}, {0, 2, 6},
                                                       {1, 5, 7}, {0, 3, 2}, {4, 7, 5}, {0, 5, 1}, {2, 7, 6},
                                                       {0, 6, 4}, {1, 7, 3}, {8, 9, 10}};
  audit::set_edges(triangles, {}, out.mesh);
  out.mesh.triangles = audit::as_columns(triangles);
  out.names = {{"cube", "leaf"}, {0, 8}, {}};
  return out;
}

std::string frame(double z) {
  Positions x(3, 11);
  for (int v = 0; v < 8; ++v) x.col(v) = Vec3d(v >> 2, (v >> 1) & 1, v & 1);
  x.col(8) = Vec3d(0.3, 0.31, z), x.col(9) = Vec3d(0.5, 0.33, z), x.col(10) = Vec3d(0.41, 0.6, z);
  return {reinterpret_cast<const char*>(x.data()), static_cast<std::size_t>(x.size()) * sizeof(double)};
}

struct Judged {
  bool clean;
  std::vector<json> frames;
  json total;
};

Judged judged(const Subject& subject, const std::string& bytes) {
  std::istringstream in(bytes);
  std::ostringstream out;
  Judged result{judge(subject, in, out).clean, {}, {}};
  std::istringstream lines(out.str());
  for (std::string line; std::getline(lines, line);) result.frames.push_back(json::parse(line));
  result.total = result.frames.back()["total"];
  result.frames.pop_back();
  return result;
}

TEST(Judge, a_clean_fall_is_clean_and_says_what_was_judged) {
  const Judged found = judged(cube_and_leaf(), frame(3) + frame(2.5) + frame(1.25));
  EXPECT_TRUE(found.clean);
  ASSERT_EQ(found.frames.size(), 3u);
  EXPECT_EQ(found.total["frames"], 3);
  EXPECT_GT(found.total["judged"], 0);
  EXPECT_EQ(found.total["sides_asked"], 9);
  EXPECT_EQ(found.total["closed_bodies"], json({"cube"}));
  EXPECT_TRUE(found.frames[0]["gap_between_m"].get<double>() > 0.5) << "of the cube's own corners";
  EXPECT_NEAR(found.frames[2]["gap_between_m"], 0.25, 1e-15);
  EXPECT_TRUE(found.frames[0]["gap_obstacles_m"].is_null());
  EXPECT_FALSE(found.frames[0].contains("motion"));
  long counted = 0;
  for (const json& bin : found.total["gap_histogram"]) {
    if (bin["from_m"].is_number() && bin["from_m"] < 0.26) counted += bin["vertices"].get<long>();
  }
  EXPECT_EQ(counted, 3) << "the leaf at 0.25 alone";
}

TEST(Judge, a_crossing_is_named_with_its_depth) {
  Subject subject = cube_and_leaf();
  std::string bytes = frame(1.25);
  Positions x(3, 11);
  std::memcpy(x.data(), bytes.data(), bytes.size());
  x(2, 10) = 0.9;
  std::memcpy(bytes.data(), x.data(), bytes.size());
  const Judged found = judged(subject, frame(1.25) + bytes);
  EXPECT_FALSE(found.clean);
  EXPECT_EQ(found.frames[0]["crossings"], 0);
  EXPECT_EQ(found.frames[1]["crossings"], 2);
  EXPECT_NEAR(found.frames[1]["deepest_m"], 0.1, 1e-14);
  EXPECT_NE(found.frames[1]["deepest"].get<std::string>().find("crosses triangle cube["), std::string::npos);
  EXPECT_EQ(found.frames[1]["changed_sides"], 1);
  EXPECT_NEAR(found.frames[1]["depth_bodies_m"], 0.1, 1e-14);
}

TEST(Judge, what_is_inside_afterwards_has_passed_whatever_the_path) {
  const Judged found = judged(cube_and_leaf(), frame(2) + frame(0.5));
  EXPECT_FALSE(found.clean);
  EXPECT_EQ(found.frames[1]["crossings"], 0) << "no frame shows it";
  EXPECT_EQ(found.total["changed_sides"], 3);
  EXPECT_EQ(found.frames[1]["first_changed"], "vertex leaf[0] is on the other side of cube");
  EXPECT_NEAR(found.frames[1]["depth_bodies_m"], 0.4, 1e-14) << "of the corner at y = 0.6";
  EXPECT_GT(found.total["passages"], 0);
}

TEST(Judge, the_depth_is_that_of_what_has_come_in_since_the_first_frame) {
  const Judged found = judged(cube_and_leaf(), frame(2) + frame(0.5) + frame(0.5) + frame(0.75) + frame(3));
  EXPECT_EQ(found.total["changed_sides"], 6) << "into the cube, and out of it";
  EXPECT_NEAR(found.frames[2]["depth_bodies_m"], 0.4, 1e-14) << "it stays where it is";
  EXPECT_NEAR(found.frames[3]["depth_bodies_m"], 0.25, 1e-14);
  EXPECT_EQ(found.frames[4]["depth_bodies_m"], 0.0);
}

TEST(Judge, a_frame_on_the_surface_hides_no_passage) {
  const Judged found = judged(cube_and_leaf(), frame(2) + frame(1) + frame(0.5));
  EXPECT_EQ(found.total["changed_sides"], 3);
}

TEST(Judge, what_starts_inside_a_body_is_held_by_it) {
  const Judged held = judged(cube_and_leaf(), frame(0.5) + frame(0.75));
  EXPECT_TRUE(held.clean);
  EXPECT_EQ(held.frames[1]["inside"], 3);
  EXPECT_EQ(held.frames[1]["depth_bodies_m"], 0.0);
}

TEST(Judge, a_passage_of_the_straight_line_is_said_apart) {
  const Judged found = judged(cube_and_leaf(), frame(2) + frame(-1));
  EXPECT_FALSE(found.clean);
  EXPECT_EQ(found.total["crossings"], 0);
  EXPECT_EQ(found.total["changed_sides"], 0);
  EXPECT_GT(found.total["passages"], 0);
}

TEST(Judge, obstacles_and_numbers_that_are_none) {
  Subject subject = cube_and_leaf();
  subject.mesh.obstacles = {{audit::ObstacleKind::plane, Vec3d(0, 0, 1.5), Vec3d(0, 0, -1)}};
  subject.names.obstacles = {"ceiling"};
  const Judged above = judged(subject, frame(2));
  EXPECT_EQ(above.total["obstacle_violations"], 3);
  EXPECT_EQ(above.frames[0]["first"], "vertex leaf[0] is on the wrong side of obstacle ceiling");
  EXPECT_NEAR(above.frames[0]["gap_obstacles_m"], -0.5, 1e-15);
  const Judged broken = judged(cube_and_leaf(), frame(3) + frame(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_FALSE(broken.clean);
  EXPECT_EQ(broken.frames[1]["finite"], false);
  EXPECT_EQ(broken.total["not_finite"], 2) << "the state and the motion to it";
}

TEST(Judge, refuses_no_frame_and_half_a_frame) {
  std::ostringstream out;
  for (const std::string& bytes : {std::string(), frame(2).substr(0, 100), frame(2) + "x"}) {
    std::istringstream in(bytes);
    EXPECT_THROW(judge(cube_and_leaf(), in, out), ConfigError) << bytes.size();
  }
}

}  // namespace
}  // namespace bb::judge::judge_test
