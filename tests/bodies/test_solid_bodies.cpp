// Bodies of tetrahedra: masses, elements, the surface that touches, and what is refused.
#include <gtest/gtest.h>

#include <numeric>

#include "core/model/bodies/part.hpp"
#include "core/model/mesh/solid_generators.hpp"
#include "core/model/mesh/topology.hpp"
#include "tests/bodies/bodies.hpp"

namespace bb::test::solid_bodies {
namespace {

BodySpec block(const std::string& name, double height = 0) {
  BodySpec body;
  body.name = name;
  body.mesh = solid_box_mesh({2, 2, 2}, Vec3d(1, 0.5, 0.5));
  body.mesh.vertices.row(2).array() += height;
  body.d_hat = 0.01;
  return body;
}

TEST(SolidBodies, lump_density_times_volume_a_quarter_of_each_tetrahedron) {
  BodySpec body = block("block");
  body.material.solid_density = 800;
  const Scene scene = scene_of({body});
  EXPECT_NEAR(std::accumulate(scene.mass.begin(), scene.mass.end(), 0.0), 800 * 0.25, 1e-12);
  EXPECT_NEAR(scene.mass[0], 800 * 0.25 / 48 / 4 * 6, 1e-13);    // the corner where all six of a cell meet
  EXPECT_NEAR(scene.mass[13], 800 * 0.25 / 48 / 4 * 24, 1e-13);  // the middle
}

TEST(SolidBodies, touch_with_their_surface_alone) {
  const Scene scene = scene_of({block("low"), block("high", 1)});
  EXPECT_EQ(scene.solids.at(0).tetrahedra.size(), 96u);
  EXPECT_EQ(scene.surface_triangles.size(), 2 * 48u);
  EXPECT_EQ(scene.surface_edges.size(), 2 * 72u);
  EXPECT_EQ(scene.surface_vertices.size(), 2 * 26u);
  for (const int inner : {13, 27 + 13}) {
    EXPECT_EQ(std::count(scene.surface_vertices.begin(), scene.surface_vertices.end(), inner), 0);
  }
}

TEST(SolidBodies, keep_model_and_lame_parameters_of_every_body) {
  BodySpec first = block("first"), second = block("second", 1), third = block("third", 2);
  first.material.solid_model = third.material.solid_model = "stvk";
  first.material.solid_youngs = 1000;
  first.material.solid_poisson = 0.25;
  const Scene scene = scene_of({first, second, third});
  ASSERT_EQ(scene.solids.size(), 2u);
  EXPECT_EQ(scene.solids[0].model, "stvk");
  EXPECT_EQ(scene.solids[1].model, "corotational");
  ASSERT_EQ(scene.solids[0].tetrahedra.size(), 96u);
  EXPECT_NEAR(scene.solids[0].lame_mu[0], 400, 1e-12);
  EXPECT_NEAR(scene.solids[0].lame_lambda[0], 400, 1e-12);
  EXPECT_EQ(scene.solids[0].tetrahedra[48][0] / 27, 2);  // of the third body
  EXPECT_EQ(parts::tetrahedra::part().size(scene), 144u);
}

TEST(SolidBodies, a_triangle_of_the_mesh_stands_for_the_face_that_it_lies_on) {
  BodySpec coated = block("coated");
  const auto face = solid_faces(coated.mesh.tetrahedra).surface.front();
  coated.mesh.triangles = {{face[1], face[2], face[0]}, {0, 2, 13}};
  const Scene scene = scene_of({coated});
  EXPECT_EQ(scene.surface_triangles.size(), 49u);
  EXPECT_EQ(scene.membrane_triangles().size(), 2u);
  EXPECT_EQ(scene.surface_vertices.size(), 27u);  // the second triangle takes the middle to the surface
}

TEST(SolidBodies, rigid_ones_have_a_surface_and_no_elements) {
  BodySpec rigid = block("rigid");
  rigid.kind = BodyKind::rigid;
  const Scene scene = scene_of({rigid, block("free", 1)});
  EXPECT_EQ(scene.solids.at(0).tetrahedra.size(), 48u);
  EXPECT_EQ(scene.surface_triangles.size(), 96u);
  EXPECT_EQ(scene.mass[0], 0);
}

TEST(SolidBodies, springs_lie_on_every_edge_of_the_tetrahedra) {
  BodySpec body = block("block");
  body.material.solid_model = "none";
  body.material.springs = 10;
  const Scene scene = scene_of({body});
  EXPECT_TRUE(scene.solids.empty());
  EXPECT_EQ(scene.springs.edges.size(), 98u);  // 54 along the axes, 36 across faces of cells, 8 across cells
}

TEST(SolidBodies, are_refused_with_the_number_of_the_tetrahedron) {
  BodySpec body = block("block");
  std::swap(body.mesh.tetrahedra[7][0], body.mesh.tetrahedra[7][1]);
  EXPECT_NE(complaint({body}).find("tetrahedron 7 of -0.00520833 m^3"), std::string::npos)
      << complaint({body});
  body.mesh.tetrahedra[7][0] = body.mesh.tetrahedra[7][1];
  EXPECT_NE(complaint({body}).find("0 m^3"), std::string::npos) << complaint({body});
  body.mesh.tetrahedra[7][0] = 27;
  EXPECT_NE(complaint({body}).find("tetrahedron 7 with an unknown vertex"), std::string::npos);
  body = block("block");
  body.kind = BodyKind::rigid;
  body.mesh.tetrahedra[3] = {0, 1, 2, 2};
  EXPECT_NE(complaint({body, cloth("cloth", 3)}).find("tetrahedron 3 of 0 m^3"), std::string::npos);
  body = block("block");
  body.mesh.tetrahedra.push_back(body.mesh.tetrahedra[5]);
  body.mesh.tetrahedra.push_back(body.mesh.tetrahedra[5]);
  EXPECT_NE(complaint({body}).find("with a face that two others have too"), std::string::npos);
}

TEST(SolidBodies, materials_out_of_range_are_refused) {
  BodySpec body = block("block");
  body.material.solid_model = "stvc";
  EXPECT_NE(complaint({body}).find("/material/solid_model: found \"stvc\""), std::string::npos)
      << complaint({body});
  body.material.solid_model = "arap";
  body.material.solid_poisson = 0.5;
  EXPECT_NE(complaint({body}).find("/material/solid_poisson"), std::string::npos);
  body.material.solid_poisson = 0.1;
  EXPECT_EQ(complaint({body}), "");
  body.material.solid_model = "stable_neo_hookean";
  EXPECT_NE(complaint({body}).find("a number > 0.125"), std::string::npos) << complaint({body});
  body.material.solid_poisson = 0.13;
  EXPECT_EQ(complaint({body}), "");
  body.material.solid_youngs = 0;
  EXPECT_NE(complaint({body}).find("/material/solid_youngs_Pa"), std::string::npos);
}

TEST(SolidBodies, frames_say_the_smallest_volume_ratio_at_every_vertex) {
  const Scene scene = scene_of({cloth("cloth", 3), block("block")});
  Positions x = scene.x0;
  x.rightCols(27) *= 0.5;
  FrameFields fields;
  parts::tetrahedra::part().add_frame_fields(scene, x, fields);
  ASSERT_EQ(fields.of_vertices.size(), 1u);
  EXPECT_EQ(fields.of_vertices[0].name, "volume_ratio");
  const auto& ratios = std::get<std::vector<double>>(fields.of_vertices[0].values);
  EXPECT_EQ(ratios.front(), 1);
  EXPECT_NEAR(ratios.back(), 0.125, 1e-14);
  FrameFields none;
  parts::tetrahedra::part().add_frame_fields(scene_of({cloth("cloth")}), Positions(3, 12), none);
  EXPECT_TRUE(none.of_vertices.empty());
}

}  // namespace
}  // namespace bb::test::solid_bodies
