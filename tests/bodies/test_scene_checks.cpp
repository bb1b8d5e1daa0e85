// Scenes that cannot be run are refused, all violations at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "core/model/mesh/solid_generators.hpp"
#include "tests/bodies/bodies.hpp"

namespace bb::scene_checks_test {
namespace {

using namespace test;
using ::testing::Test;

void expect_complaint(const std::string& found, const std::string& expected) {
  EXPECT_NE(found.find(expected), std::string::npos) << "found: " << found << "\nexpected: " << expected;
}

TEST(scene_checks, refuse_a_scene_without_free_vertices) {
  expect_complaint(complaint({}), "no body");
  expect_complaint(complaint({rigid_box("box")}), "no free vertex");
  BodySpec held = cloth("held");
  held.pins.emplace_back().all = true;
  expect_complaint(complaint({held}), "no free vertex");
}

TEST(scene_checks, refuse_free_vertices_without_mass) {
  BodySpec light = cloth("light");
  light.material.density = 0;
  BodySpec loose = cloth("loose", 1);
  loose.mesh.vertices.conservativeResize(3, 13);
  loose.mesh.vertices.col(12) = Vec3d(5, 5, 5);

  const std::string found = complaint({light, loose});

  expect_complaint(found, "body \"light\": found 12 free vertices without mass, the first is 0");
  expect_complaint(found, "body \"loose\": found 1 free vertices without mass, the first is 12");
}

/// What is reported of a material of a body with this mesh and nothing else wrong.
std::string said_of(const TriangleMesh& mesh, const std::function<void(Material&)>& change) {
  BodySpec body = cloth("body");
  body.mesh = mesh;
  if (!mesh.segments.empty()) body.material.line_density = 0.1;
  change(body.material);
  return complaint({body});
}

TEST(scene_checks, refuse_bending_of_an_edge_that_three_triangles_share) {
  TriangleMesh fan = grid_mesh(2, 2, 1, 1);  // triangles (0, 1, 3) and (0, 3, 2)
  fan.vertices.conservativeResize(3, 5);
  fan.vertices.col(4) = Vec3d(0, 0, 1);
  fan.triangles.push_back({3, 0, 4});

  expect_complaint(said_of(fan, [](Material& m) { m.bending = 0.25; }),
                   "/material/bending_J: found 0.25, and 3 triangles share the edge of vertices 0 and 3; "
                   "allowed: 0, or a mesh of which at most two triangles share an edge");
  expect_complaint(said_of(fan, [](Material& m) { m.bending_exponential = 0.5; }),
                   "/material/bending_exponential_J: found 0.5, and 3 triangles");
  EXPECT_EQ(said_of(fan, [](Material&) {}), "");
  EXPECT_EQ(said_of(grid_mesh(2, 2, 1, 1), [](Material& m) { m.bending = 0.25; }), "");
}

TEST(scene_checks, refuse_a_key_of_elements_that_the_body_cannot_have) {
  const TriangleMesh sheet = grid_mesh(2, 2, 1, 1), rod = rod_mesh(3, Vec3d(0, 0, 0), Vec3d(1, 0, 0));
  const TriangleMesh block = solid_box_mesh({1, 1, 1}, Vec3d(1, 1, 1));
  struct Case {
    const char *key, *lacks;
    std::function<void(Material&)> change;
    std::vector<TriangleMesh> refused, allowed;
  };
  const Case cases[] = {
      {"youngs_N_per_m", "no triangle", [](Material& m) { m.youngs = 7; }, {rod, block}, {sheet}},
      {"density_kg_per_m2", "no triangle", [](Material& m) { m.density = 7; }, {rod, block}, {sheet}},
      {"bending_J", "no triangle", [](Material& m) { m.bending = 7; }, {rod, block}, {sheet}},
      {"cloth_tension_N_per_m", "no face", [](Material& m) { m.cloth_tension = 7; }, {rod, block}, {sheet}},
      {"solid_youngs_Pa", "no tetrahedron", [](Material& m) { m.solid_youngs = 7; }, {rod, sheet}, {block}},
      {"rod_bending_N_m2",
       "no two lone edges",
       [](Material& m) { m.rod_bending = 7; },
       {sheet, block},
       {rod}},
      {"line_density_kg_per_m",
       "no lone edge",
       [](Material& m) { m.line_density = 7; },
       {sheet, block},
       {rod}},
      {"rod_stretching_N", "no lone edge", [](Material& m) { m.rod_stretching = 7; }, {sheet, block}, {rod}},
  };
  for (const Case& c : cases) {
    for (const TriangleMesh& mesh : c.refused) {
      const std::string found = said_of(mesh, c.change);
      expect_complaint(found, std::string("body \"body\"/material/") + c.key);
      expect_complaint(found, c.lacks);
    }
    for (const TriangleMesh& mesh : c.allowed) EXPECT_EQ(said_of(mesh, c.change), "") << c.key;
  }
}

TEST(scene_checks, say_once_what_a_body_has_nothing_for) {
  const TriangleMesh rod = rod_mesh(3, Vec3d(0, 0, 0), Vec3d(1, 0, 0));
  const auto lines_of = [&](const std::function<void(Material&)>& change) {
    const std::string found = said_of(rod, change);
    return std::count(found.begin(), found.end(), '\n') + !found.ends_with('\n');
  };
  const auto shrunk = [](Material& m) {
    m.shrink_warp = 0.9;
    m.warp_axis = Vec3d::UnitX();  // as a config settles it
  };
  EXPECT_EQ(lines_of(shrunk), 1) << said_of(rod, shrunk);
  const auto thick = [](Material& m) {
    m.youngs = 7;
    m.thickness = 1e-3;
  };
  EXPECT_EQ(lines_of(thick), 2) << said_of(rod, thick);  // youngs_Pa and thickness_m
  const auto alone = [](Material& m) { m.warp_axis = Vec3d::UnitX(); };
  EXPECT_EQ(lines_of(alone), 1) << said_of(rod, alone);
  const auto creeps = [](Material& m) { m.membrane_creep = 1; };
  EXPECT_EQ(lines_of(creeps), 1) << said_of(rod, creeps);
}

TEST(scene_checks, allow_what_switches_off_elements_that_the_body_cannot_have) {
  const TriangleMesh rod = rod_mesh(3, Vec3d(0, 0, 0), Vec3d(1, 0, 0));
  EXPECT_EQ(said_of(rod,
                    [](Material& m) {
                      m.model = m.solid_model = "none";
                      m.density = m.solid_density = 0;
                    }),
            "");
}

TEST(scene_checks, refuse_a_membrane_whose_energy_has_no_bound) {
  const TriangleMesh sheet = grid_mesh(2, 2, 1, 1);
  struct Case {
    const char* model;
    double poisson;
    const char* allowed;  // empty: it is taken
  };
  const Case cases[] = {
      {"stable_neo_hookean", -0.2, "a number > 0 with model stable_neo_hookean"},
      {"stable_neo_hookean", 0, "a number > 0 with model stable_neo_hookean"},
      {"stable_neo_hookean", 0.01, ""},
      {"baraff_witkin", -0.2, "a number >= 0 with model baraff_witkin"},
      {"baraff_witkin", 0, ""},
      {"corotational", -0.9, ""},
      {"arap", -0.9, ""},
      {"stvk", -0.9, ""},
      {"none", -0.9, ""},
  };
  for (const Case& c : cases) {
    const std::string found = said_of(sheet, [&](Material& m) {
      m.model = c.model;
      m.poisson = c.poisson;
      if (m.model == "baraff_witkin") m.warp_axis = Vec3d::UnitX();
    });
    if (std::string(c.allowed).empty()) {
      EXPECT_EQ(found, "") << c.model;
      continue;
    }
    expect_complaint(found, "body \"body\"/material/poisson");
    expect_complaint(found, c.allowed);
  }
}

TEST(scene_checks, refuse_a_name_used_twice) {
  Obstacle plane;
  plane.name = "cloth";
  plane.point = Vec3d(0, 0, -3);

  expect_complaint(complaint({cloth("cloth"), cloth("cloth", 1)}), "a name used twice");
  expect_complaint(complaint({cloth("cloth")}, {plane}), "a name used twice");
}

TEST(scene_checks, refuse_a_ball_or_a_bar_without_a_radius) {
  for (const ObstacleKind kind : {ObstacleKind::sphere, ObstacleKind::cylinder}) {
    for (const double radius : {0.0, -0.1, std::nan("")}) {
      Obstacle o;
      o.name = "post";
      o.kind = kind;
      o.point = Vec3d(0, 0, -30);
      o.radius = radius;
      expect_complaint(complaint({cloth("cloth")}, {o}), "obstacle \"post\"/radius");
    }
  }
}

TEST(scene_checks, refuse_an_inside_that_is_too_small_for_a_body) {
  BodySpec body = cloth("cloth");  // in the x-y plane
  double width = 0, across = 0;
  for (Eigen::Index a = 0; a < body.mesh.vertices.cols(); ++a) {
    for (Eigen::Index b = 0; b < a; ++b) {
      const Vec3d r = body.mesh.vertices.col(a) - body.mesh.vertices.col(b);
      width = std::max(width, r.norm());
      across = std::max(across, std::abs(r[1]));
    }
  }
  ASSERT_GT(width, across);
  body.offset = 0.1;
  Obstacle shell;
  shell.name = "shell";
  shell.kind = ObstacleKind::sphere;
  shell.inside = true;
  shell.radius = width / 2 + 0.11;
  EXPECT_EQ(complaint({body}, {shell}), "");
  shell.radius = width / 2 + 0.09;
  expect_complaint(complaint({body}, {shell}), "body \"cloth\" inside obstacle \"shell\"");
  shell.inside = false;
  EXPECT_EQ(complaint({body}, {shell}), "");
  Obstacle pipe = shell;
  pipe.kind = ObstacleKind::cylinder;
  pipe.axis = Vec3d::UnitX();  // the cloth may be long along it
  pipe.inside = true;
  pipe.radius = across / 2 + 0.11;
  EXPECT_EQ(complaint({body}, {pipe}), "");
  pipe.radius = across / 2 + 0.09;
  expect_complaint(complaint({body}, {pipe}), "inside obstacle \"shell\"");
}

TEST(scene_checks, refuse_bad_meshes) {
  BodySpec body = cloth("cloth");
  body.mesh.vertices(1, 2) = std::nan("");
  expect_complaint(complaint({body}), "finite coordinates between");
  body = cloth("cloth");
  body.mesh.triangles[3][1] = 12;
  expect_complaint(complaint({body}), "unknown vertex");
  body = cloth("cloth");
  body.mesh.vertices.col(0) = body.mesh.vertices.col(1);
  expect_complaint(complaint({body}), "zero area");
  body = cloth("cloth");
  body.start = Positions::Zero(3, 3);
  expect_complaint(complaint({body}), "do not fit");
  EXPECT_EQ(complaint({cloth("cloth")}), "");
}

TEST(scene_checks, refuse_every_material_value_out_of_range_at_once) {
  BodySpec body = cloth("cloth");
  body.material.model = "neo";
  body.material.youngs = -1;
  body.material.poisson = 1;
  body.material.density = std::numeric_limits<double>::infinity();
  body.material.bending = -1;
  body.material.limit = StrainLimitSpec{-0.1, 0};
  body.d_hat = 0;

  const std::string found = complaint({body});

  for (const char* what : {"model", "youngs", "poisson", "density", "bending", "onset", "width", "d_hat"}) {
    expect_complaint(found, std::string("/") + what);
  }
  expect_complaint(found, "one of corotational, arap, stvk, stable_neo_hookean, baraff_witkin, none");
}

TEST(scene_checks, refuse_bad_pins_and_motions) {
  BodySpec body = cloth("cloth");
  body.pins.emplace_back().indices = {12};
  expect_complaint(complaint({body}), "found vertex 12; allowed: 0 to 11");
  body = cloth("cloth");
  body.pins.emplace_back().box = {Vec3d(5, 5, 5), Vec3d(6, 6, 6)};
  expect_complaint(complaint({body}), "no vertex selected");
  body = cloth("cloth");
  body.pins.resize(2);
  body.pins[0].indices = {1};
  body.pins[1].indices = {1};
  body.pins[1].motion.velocity = Vec3d(1, 0, 0);
  expect_complaint(complaint({body}), "two motions");
  BodySpec box = rigid_box("box");
  box.motion.axis = Vec3d(0, 0, 2);
  box.motion.start = 2;
  box.motion.end = 1;
  expect_complaint(complaint({cloth("cloth", 1), box}), "unit axis");
  expect_complaint(complaint({cloth("cloth", 1), box}), "end >= start");
}

TEST(scene_checks, refuse_what_leaves_the_plane_of_a_planar_scene) {
  BodySpec body = cloth("cloth", 0.1);
  body.material.bending = 1;
  body.velocity = Vec3d(0, 0, 1);
  Obstacle plane;
  plane.name = "plane";
  plane.axis = Vec3d::UnitZ();

  const std::string found = complaint({body}, {plane}, true);

  for (const char* what : {"/mesh", "/material/bending", "/velocity", "/axis"}) expect_complaint(found, what);
}

TEST(scene_checks, refuse_bad_obstacles) {
  Obstacle sphere;
  sphere.name = "sphere";
  sphere.kind = ObstacleKind::sphere;
  Obstacle plane;
  plane.name = "plane";
  plane.axis = Vec3d(0, 0, 3);

  const std::string found = complaint({cloth("cloth")}, {sphere, plane});

  expect_complaint(found, "\"sphere\"/radius: found 0; allowed: a number > 0");
  expect_complaint(found, "\"plane\"/axis");
}

}  // namespace
}  // namespace bb::scene_checks_test
