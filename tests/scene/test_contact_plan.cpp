// Which contacts a scene can have at all.
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "core/model/scene/contact_plan.hpp"
#include "tests/bodies/bodies.hpp"

namespace bb::contact_plan_test {
namespace {

using namespace test;

/// A chain of free vertices at distance 1.
BodySpec rod(int n) {
  BodySpec body;
  body.name = "rod";
  body.mesh.vertices = Positions::Zero(3, n);
  for (int i = 0; i < n; ++i) body.mesh.vertices(0, i) = i;
  for (int i = 0; i + 1 < n; ++i) body.mesh.segments.push_back({i, i + 1});
  body.material.line_density = 1;
  body.material.springs = 1;
  body.material.model = "none";
  body.d_hat = 0.01;
  return body;
}

BodySpec triangle() {
  BodySpec body;
  body.name = "triangle";
  body.mesh.vertices = Positions::Identity(3, 3);
  body.mesh.triangles = {{0, 1, 2}};
  body.d_hat = 0.01;
  return body;
}

TEST(ContactPlan, of_cloth_over_a_box_has_pairs_in_space_of_both_kinds) {
  const ContactPlan plan = plan_contact(scene_of({cloth("cloth", 1), rigid_box("box")}));
  EXPECT_TRUE(plan.point_triangle && plan.edge_edge);
  EXPECT_FALSE(plan.point_point || plan.point_edge);
  EXPECT_TRUE(plan.self_contact.needed && plan.given_surfaces.needed);
  EXPECT_FALSE(plan.obstacles.needed);
}

TEST(ContactPlan, of_elements_that_all_share_a_vertex_is_empty) {
  EXPECT_FALSE(plan_contact(scene_of({triangle()})).any());
  EXPECT_FALSE(plan_contact(scene_of({rod(2)})).any());
}

TEST(ContactPlan, of_a_rod_has_its_vertices_and_edges) {
  const ContactPlan three =
      plan_contact(scene_of({rod(3)}));  // two edges with one end in common, and the other ends
  EXPECT_TRUE(three.point_edge && three.self_contact.needed);
  EXPECT_FALSE(three.edge_edge || three.point_triangle || three.point_point);
  const ContactPlan four = plan_contact(scene_of({rod(4)}));
  EXPECT_TRUE(four.edge_edge && four.point_edge);
}

TEST(ContactPlan, of_a_chain_in_the_plane_has_its_ends) {
  Scene scene = scene_of({rod(3)}, true);
  scene.planar_pairs = PlanarPairs::vertex_vertex;
  EXPECT_TRUE(plan_contact(scene).point_point);
  EXPECT_TRUE(plan_contact(scene).self_contact.needed);
  scene.planar_pairs = PlanarPairs::point_edge;
  EXPECT_TRUE(plan_contact(scene).point_edge);
  EXPECT_FALSE(plan_contact(scene).point_point);
}

TEST(ContactPlan, mollifies_edges_that_may_be_parallel_to_a_bar) {
  Scene scene = scene_of({rod(2)});
  scene.obstacles.emplace_back();
  scene.obstacles[0].kind = ObstacleKind::sphere;
  scene.obstacles[0].radius = 1;
  EXPECT_FALSE(plan_contact(scene).mollifier.needed);
  scene.obstacles[0].kind = ObstacleKind::cylinder;
  EXPECT_TRUE(plan_contact(scene).mollifier.needed);
  EXPECT_FALSE(plan_contact(scene, Mollifier::none).mollifier.needed);
  scene.obstacles[0].inside = true;
  EXPECT_FALSE(plan_contact(scene).mollifier.needed);
  scene.obstacles[0].inside = false;
  scene.planar = true;  // across the plane it is a disk
  EXPECT_FALSE(plan_contact(scene).mollifier.needed);
  scene.obstacles[0].axis = Vec3d::UnitX();
  EXPECT_TRUE(plan_contact(scene).mollifier.needed);
}

TEST(ContactPlan, of_a_scene_without_free_surface_is_empty) {
  Scene scene = scene_of({cloth("cloth")});
  scene.obstacles.emplace_back();
  EXPECT_TRUE(plan_contact(scene).obstacles.needed);
  scene.motions.resize(1);
  for (int v = 0; v < scene.n_vertices(); ++v) scene.pins.push_back({v, 0});
  EXPECT_FALSE(plan_contact(scene).any());
  EXPECT_EQ(plan_contact(scene).obstacles.reason, "no free surface vertex");
}

/// Edges and triangles among few vertices, many of them more than once and in both directions.
Scene tangle(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> vertex(0, 24), size(0, 60);
  Scene scene;
  scene.x0 = scene.rest = Positions::Zero(3, 25);
  for (int i = size(random); i > 0; --i) scene.surface_edges.push_back({vertex(random), vertex(random)});
  for (int i = size(random) / 4; i > 0; --i)
    scene.surface_triangles.push_back({vertex(random), vertex(random), vertex(random)});
  return scene;
}

TEST(ContactPlan, LoneEdgesAreThoseThatASetOfEdgesHas) {
  std::size_t found = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const Scene scene = tangle(seed);
    const auto ascending = [](int a, int b) { return a < b ? std::array{a, b} : std::array{b, a}; };
    std::set<std::array<int, 2>> expected;
    for (const auto& e : scene.surface_edges) expected.insert(ascending(e[0], e[1]));
    for (const auto& t : scene.surface_triangles) {
      for (std::size_t k = 0; k < 3; ++k) expected.erase(ascending(t[k], t[(k + 1) % 3]));
    }
    const std::vector<std::array<int, 2>> lone = lone_edges(scene);
    EXPECT_EQ(lone, (std::vector<std::array<int, 2>>(expected.begin(), expected.end()))) << seed;
    found += lone.size();
  }
  EXPECT_GT(found, 1000u);
}

}  // namespace
}  // namespace bb::contact_plan_test
