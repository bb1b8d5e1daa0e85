// Mesh files as frames: polygons cut, cells counted, fields by name; positions may be anything.
#include <gtest/gtest.h>

#include "core/math/error.hpp"
#include "core/model/mesh/frame_mesh.hpp"
#include "core/model/mesh/topology.hpp"
#include "tests/mesh/mesh_bytes.hpp"

namespace bb {
namespace {

double area_of(const FrameMesh& mesh) {
  double area = 0;
  for (const auto& t : mesh.triangles) area += area_vector(mesh.vertices, t).norm();
  return area;
}

TEST(frame_mesh, cuts_a_polygon_that_no_fan_covers) {
  // A comb of two teeth: no corner sees all of it.
  const std::string comb =
      "v 0 0 0\nv 5 0 0\nv 5 2 0\nv 4 2 0\nv 4 1 0\nv 3 1 0\nv 3 2 0\nv 2 2 0\nv 2 1 0\nv 0 1 0\nf 1 2 3 4 5 "
      "6 7 8 9 10\n";

  const FrameMesh mesh = parse_frame(comb, "a.obj");

  EXPECT_EQ(mesh.triangles.size(), 8u);
  EXPECT_EQ(mesh.sizes, std::vector<int>{10});
  EXPECT_DOUBLE_EQ(area_of(mesh), 7.0);
  for (const auto& t : mesh.triangles) EXPECT_GE(area_vector(mesh.vertices, t)[2], 0);
  EXPECT_TRUE(mesh.notes.empty());
}

TEST(frame_mesh, has_texture_coordinates_of_corners_where_they_are_asked_for) {
  const std::string text =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0.5 0.25 7\nvt 2\nf 1/2 2//3 3/-2/1\nf 1/3 3 4/1\nvt 3 4\n";
  const FrameMesh mesh = parse_frame(text, "a.obj", {}, true);

  EXPECT_EQ(mesh.uvs, (std::vector<std::array<double, 2>>{{0.5, 0.25}, {2, 0}, {3, 4}}));
  EXPECT_EQ(mesh.corner_uvs, (std::vector<int>{1, -1, 0, 2, -1, 0}));
  EXPECT_EQ(mesh.corner_uvs.size(), mesh.corners.size());
  EXPECT_TRUE(parse_frame(text, "a.obj").corner_uvs.empty());
  const std::string wrong = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt half\nf 1/9 2 3\n";
  EXPECT_EQ(parse_frame(wrong, "a.obj").triangles.size(), 1u);  // read past
  EXPECT_THROW(parse_frame(wrong, "a.obj", {}, true), ConfigError);
  EXPECT_THROW(parse_frame("v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nf 1/2 2 3\n", "a.obj", {}, true), ConfigError);
}

TEST(frame_mesh, says_where_the_sides_of_a_polygon_cross) {
  const FrameMesh mesh = parse_frame("v 0 0 0\nv 2 2 0\nv 3 0 0\nv 0 3 0\nf 1 2 3 4\n", "a.obj");

  EXPECT_EQ(mesh.triangles.size(), 2u);
  ASSERT_EQ(mesh.notes.size(), 1u);
  EXPECT_EQ(mesh.notes[0],
            "a polygon whose sides cross: 1 cut into triangles from the first corner, the first at a.obj:5");
}

TEST(frame_mesh, takes_positions_that_are_none_and_faces_without_area) {
  const FrameMesh mesh =
      parse_frame("v nan 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nf 1 2 3\nf 2 3 4\nf 2 3 4\nf 1 2 3 4\n", "a.obj");

  EXPECT_EQ(mesh.triangles.size(), 5u);
  EXPECT_TRUE(std::isnan(mesh.vertices(0, 0)));
  EXPECT_THROW(parse_frame("v 0 0 0\nv 1 0 0\nf 1 2 2\n", "a.obj"), ConfigError);
}

TEST(frame_mesh, has_the_fields_that_are_asked_for) {
  for (const auto& [name, bytes] :
       {std::pair{"a.vtu", test::tetrahedron_vtu_ascii()}, {"a.vtk", test::tetrahedron_vtk_ascii()}}) {
    const FrameMesh listed = parse_frame(bytes, name), read = parse_frame(bytes, name, {"u"});

    ASSERT_EQ(listed.fields.size(), 1u);
    EXPECT_EQ(listed.fields[0].name, "u");
    EXPECT_EQ(listed.fields[0].components, 3);
    EXPECT_TRUE(listed.fields[0].values.empty());
    EXPECT_EQ(read.fields[0].values, (std::vector<double>{0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 2, 3}));
    EXPECT_THROW(parse_frame(bytes, name, {"v"}), ConfigError);
  }
}

}  // namespace
}  // namespace bb
