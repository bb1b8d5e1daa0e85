// Bodies to columns: masses, elements, surfaces, pins.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "core/model/mesh/topology.hpp"
#include "tests/bodies/bodies.hpp"

namespace bb::scene_builder_test {
namespace {

using namespace test;

double total_mass(const Scene& scene) { return std::accumulate(scene.mass.begin(), scene.mass.end(), 0.0); }

TEST(scene_builder, lumps_density_times_area) {
  BodySpec body = cloth("cloth");
  body.material.density = 0.4;

  const Scene scene = scene_of({body});

  EXPECT_NEAR(total_mass(scene), 0.4 * 1.5, 1e-15);
  EXPECT_NEAR(scene.mass[0], 0.4 * (2 * 0.5 * 0.5 * 0.5) / 3, 1e-16);  // two triangles of 0.125 m^2
  EXPECT_NEAR(scene.mass[5], 0.4 * (6 * 0.125) / 3, 1e-16);            // six around an inner vertex
}

TEST(scene_builder, lumps_line_density_times_length) {
  BodySpec rod;
  rod.name = "rod";
  rod.mesh = rod_mesh(4, Vec3d(0, 0, 0), Vec3d(2, 0, 0));
  rod.material.line_density = 0.3;
  rod.material.springs = 50;
  rod.d_hat = 0.01;

  const Scene scene = scene_of({rod});

  EXPECT_NEAR(total_mass(scene), 0.6, 1e-15);
  EXPECT_NEAR(scene.mass[0], 0.075, 1e-16);
  EXPECT_EQ(scene.springs.edges.size(), 4u);
  EXPECT_EQ(scene.springs.stiffness, std::vector<double>(4, 50.0));
  EXPECT_TRUE(scene.membranes.empty());
  EXPECT_EQ(scene.surface_edges.size(), 4u);
  EXPECT_EQ(scene.surface_vertices.size(), 5u);
}

TEST(scene_builder, keeps_the_membrane_model_of_every_body) {
  BodySpec first = cloth("first"), second = cloth("second", 1), third = cloth("third", 2);
  first.material.model = third.material.model = "stvk";
  second.material.model = "baraff_witkin";
  second.material.warp_axis = Vec3d(0.6, 0.8, 0);
  third.material.youngs *= 2;

  const Scene scene = scene_of({first, second, third});

  ASSERT_EQ(scene.membranes.size(), 2u);
  EXPECT_EQ(scene.membranes[0].model, "stvk");
  EXPECT_EQ(scene.membranes[1].model, "baraff_witkin");
  ASSERT_EQ(scene.membranes[0].triangles.size(), 24u);
  ASSERT_EQ(scene.membranes[1].triangles.size(), 12u);
  EXPECT_EQ(scene.membranes[0].triangles[12][0] / 12, 2);  // of the third body
  EXPECT_EQ(scene.membranes[0].lame_mu[12], 2 * scene.membranes[0].lame_mu[0]);
  EXPECT_TRUE(scene.membranes[0].warp.empty());
  EXPECT_EQ(scene.membranes[1].warp, std::vector<Vec3d>(12, Vec3d(0.6, 0.8, 0)));
  EXPECT_EQ(scene.membrane_triangles().size(), 36u);
}

TEST(scene_builder, wants_a_warp_axis_that_lies_in_every_triangle_and_only_where_it_is_read) {
  BodySpec body = cloth("cloth");
  body.material.model = "baraff_witkin";
  body.material.warp_axis = Vec3d(0, 0, 1);
  EXPECT_NE(complaint({body}).find("warp_axis"), std::string::npos) << complaint({body});
  EXPECT_NE(complaint({body}).find("the normal of triangle 0"), std::string::npos);
  body.material.warp_axis = Vec3d(0, 2, 0);
  EXPECT_NE(complaint({body}).find("a unit vector"), std::string::npos);
  body.material.warp_axis.reset();
  EXPECT_EQ(scene_of({body}).membranes.at(0).warp.at(0), Vec3d(1, 0, 0));
  body.material.model = "stvk";
  body.material.warp_axis = Vec3d(0, 1, 0);
  EXPECT_NE(complaint({body}).find("the model stvk has no direction"), std::string::npos);
}

TEST(scene_builder, multiplies_lame_parameters_by_the_thickness) {
  BodySpec body = cloth("cloth");
  body.material.youngs = 8e5;
  body.material.thickness = 3e-4;
  body.material.poisson = 0.25;

  const Scene scene = scene_of({body});

  ASSERT_EQ(scene.membranes.at(0).lame_mu.size(), 12u);
  EXPECT_NEAR(scene.membranes.at(0).lame_mu[3], 240 / 2.5, 1e-12);
  EXPECT_NEAR(scene.membranes.at(0).lame_lambda[3], 240 * 0.25 / (1 - 0.0625), 1e-12);
}

TEST(scene_builder, gives_hinges_the_angle_of_the_rest_shape) {
  BodySpec body = cloth("cloth");
  body.material.bending = 2e-3;
  BodySpec folded = cloth("folded", 1);
  folded.material.bending = 1e-3;
  folded.mesh.vertices.col(4)[2] += 0.2;

  const Scene scene = scene_of({body, folded});

  const std::size_t n = edge_hinges(body.mesh.triangles).size();
  ASSERT_EQ(scene.hinges.hinges.size(), 2 * n);
  EXPECT_EQ(scene.hinges.hinges[n][0], scene.hinges.hinges[0][0] + 12);
  for (std::size_t i = 0; i < n; ++i) EXPECT_EQ(scene.hinges.rest_angle[i], 0);
  double bent = 0;
  for (std::size_t i = n; i < 2 * n; ++i) bent = std::max(bent, std::abs(scene.hinges.rest_angle[i]));
  EXPECT_GT(bent, 0.1);
  EXPECT_EQ(scene.hinges.stiffness.front(), 2e-3);
  EXPECT_EQ(scene.hinges.stiffness.back(), 1e-3);
}

TEST(scene_builder, halves_a_bare_limit) {
  BodySpec body = cloth("cloth");
  body.material.limit = StrainLimitSpec{0.01, 0.01};
  body.material.density = 0.4;

  const Scene scene = scene_of({body});

  ASSERT_EQ(scene.limit.triangles.size(), 12u);
  EXPECT_EQ(scene.limit.onset[0], 0.01);
  EXPECT_EQ(scene.limit.width[0], 0.01);
  EXPECT_NEAR(scene.limit.mass[0], 0.4 * 0.125, 1e-16);
}

TEST(scene_builder, keeps_rest_and_start_apart) {
  BodySpec body = cloth("cloth");
  body.start = 1.5 * body.mesh.vertices;
  body.velocity = Vec3d(1, 2, 3);

  const Scene scene = scene_of({body});

  EXPECT_EQ(scene.rest, body.mesh.vertices);
  EXPECT_EQ(scene.x0, *body.start);
  EXPECT_EQ(scene.v0.col(7), Vec3d(1, 2, 3));
  EXPECT_NEAR(total_mass(scene), 0.2 * 1.5, 1e-15);  // of the rest shape
}

TEST(scene_builder, appends_bodies_with_their_own_numbers) {
  BodySpec thick = cloth("thick", 1);
  thick.d_hat = 0.02;
  thick.offset = 0.005;

  const Scene scene = scene_of({cloth("thin"), thick});

  ASSERT_EQ(scene.bodies.size(), 2u);
  EXPECT_EQ(scene.bodies[1].first_vertex, 12);
  EXPECT_EQ(scene.body[11], 0);
  EXPECT_EQ(scene.body[12], 1);
  EXPECT_EQ(scene.d_hat[12], 0.02);
  EXPECT_EQ(scene.offset[12], 0.005);
  EXPECT_EQ(scene.membranes[0].triangles[12], (std::array<int, 3>{12, 13, 17}));
  EXPECT_EQ(scene.surface_triangles.size(), 24u);
  EXPECT_EQ(scene.surface_edges.size(), 2 * unique_edges(thick.mesh).size());
}

TEST(scene_builder, leaves_a_rigid_body_without_mass_and_elements) {
  const Scene scene = scene_of({cloth("cloth", 1), rigid_box("box")});

  EXPECT_EQ(scene.pins.size(), 8u);
  EXPECT_EQ(scene.motions.size(), 1u);
  EXPECT_EQ(scene.membranes.at(0).triangles.size(), 12u);
  EXPECT_EQ(scene.surface_triangles.size(), 24u);
  for (int v = 12; v < 20; ++v) EXPECT_EQ(scene.mass[static_cast<std::size_t>(v)], 0);
}

TEST(scene_builder, pins_by_index_by_box_and_by_top_row) {
  BodySpec body = cloth("cloth");
  body.pins.resize(3);
  body.pins[0].indices = {5};
  body.pins[1].box = {Vec3d(-0.8, -0.6, -0.1), Vec3d(-0.7, -0.4, 0.1)};  // vertex 0
  body.pins[2].indices = {0};                                            // again, with the same motion
  BodySpec flat = cloth("flat");
  flat.pins.emplace_back().top_row = true;

  const Scene scene = scene_of({body});
  const Scene planar = scene_of({flat}, true);

  ASSERT_EQ(scene.pins.size(), 2u);
  EXPECT_EQ(scene.pins[0].vertex, 5);
  EXPECT_EQ(scene.pins[1].vertex, 0);
  EXPECT_EQ(scene.mass[5], 0);
  EXPECT_GT(scene.mass[6], 0);
  ASSERT_EQ(planar.pins.size(), 4u);
  EXPECT_EQ(planar.pins[0].vertex, 8);
}

TEST(scene_builder, leaves_out_elements_that_hold_no_unknown) {
  BodySpec body = cloth("cloth");
  body.material.springs = 10;
  body.material.limit = StrainLimitSpec{0.01, 0.01};
  body.pins.emplace_back().indices = {0, 1, 5};  // one triangle, three edges

  const Scene scene = scene_of({body});

  EXPECT_EQ(scene.membranes.at(0).triangles.size(), 11u);
  EXPECT_EQ(scene.limit.triangles.size(), 11u);
  EXPECT_EQ(scene.springs.edges.size(), unique_edges(body.mesh).size() - 3);
  EXPECT_EQ(scene.surface_triangles.size(), 12u);
}

TEST(scene_builder, gives_planar_scenes_their_boundary_edges_whatever_pairs_contact_has) {
  SceneBuilder builder("test", true, Vec3d::Zero(), "test");
  builder.set_planar_pairs(PlanarPairs::point_edge);
  builder.add_body(cloth("cloth"));

  EXPECT_EQ(builder.finish().surface_edges.size(), 10u);
  EXPECT_EQ(scene_of({cloth("cloth")}, true).surface_edges.size(), 10u);  // vertex_vertex
}

TEST(pin_pose, follows_its_motion_between_start_and_end) {
  BodySpec box = rigid_box("box");
  box.motion.velocity = Vec3d(1, 0, 0);
  box.motion.angular_velocity = std::numbers::pi;
  box.motion.start = 1;
  box.motion.end = 1.5;
  const Scene scene = scene_of({cloth("cloth", 1), box});
  const Pin& pin = scene.pins.front();
  const Vec3d x0 = scene.x0.col(pin.vertex);

  EXPECT_EQ(pin_pose(scene, pin, 0.5), x0);
  EXPECT_EQ(pin_pose(scene, pin, 1.0), x0);
  const Vec3d quarter(-x0[1] + 0.5, x0[0], x0[2]);
  EXPECT_LT((pin_pose(scene, pin, 1.5) - quarter).norm(), 1e-15);
  EXPECT_EQ(pin_pose(scene, pin, 9.0), pin_pose(scene, pin, 1.5));
  EXPECT_EQ(scene.v0.col(pin.vertex), Vec3d::Zero());  // not yet moving
}

TEST(pin_pose, has_the_start_velocity_as_its_derivative) {
  BodySpec box = rigid_box("box");
  box.motion.velocity = Vec3d(0.5, -1, 2);
  box.motion.axis = Vec3d(0.6, 0, 0.8);
  box.motion.center = Vec3d(0.1, 0.2, 0.3);
  box.motion.angular_velocity = 3;
  const Scene scene = scene_of({cloth("cloth", 1), box});

  for (const Pin& pin : scene.pins) {
    const double h = 1e-6;
    const Vec3d slope = (pin_pose(scene, pin, h) - pin_pose(scene, pin, 0)) / h;
    EXPECT_GT(slope.norm(), 0.5);
    EXPECT_LT((slope - scene.v0.col(pin.vertex)).norm(), 1e-4);
  }
}

}  // namespace
}  // namespace bb::scene_builder_test
