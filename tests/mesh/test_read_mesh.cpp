// Readers: the same tetrahedron out of every format, and what each format alone can say.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "core/model/mesh/read_mesh.hpp"
#include "core/model/mesh/topology.hpp"
#include "tests/mesh/mesh_bytes.hpp"
#include "tests/optional_data.hpp"

namespace bb {
namespace {

using namespace test;

class EveryFormat : public ::testing::TestWithParam<std::pair<std::string, std::string>> {};

TEST_P(EveryFormat, gives_the_same_tetrahedron) {
  const auto& [name, bytes] = GetParam();

  const TriangleMesh mesh = parse_mesh(bytes, name);

  ASSERT_EQ(mesh.n_vertices(), 4);
  ASSERT_EQ(mesh.triangles.size(), 4u);
  EXPECT_TRUE(mesh.segments.empty());
  EXPECT_TRUE(boundary_edges(mesh.triangles).empty());
  double volume = 0;  // STL numbers its vertices in its own order: compare what does not depend on it
  std::set<std::array<double, 3>> points;
  for (const auto& t : mesh.triangles) {
    volume += mesh.vertices.col(t[0]).dot(mesh.vertices.col(t[1]).cross(mesh.vertices.col(t[2]))) / 6;
  }
  for (int v = 0; v < 4; ++v) points.insert({mesh.vertices(0, v), mesh.vertices(1, v), mesh.vertices(2, v)});
  EXPECT_DOUBLE_EQ(volume, 1.25 / 6);
  EXPECT_EQ(points, (std::set<std::array<double, 3>>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1.25}}));
}

INSTANTIATE_TEST_SUITE_P(
    read_mesh, EveryFormat,
    ::testing::Values(
        std::pair{"a.obj", tetrahedron_obj()}, std::pair{"a.PLY", tetrahedron_ply_ascii()},
        std::pair{"le32.ply", tetrahedron_ply_binary<float>(false)},
        std::pair{"be32.ply", tetrahedron_ply_binary<float>(true)},
        std::pair{"le64.ply", tetrahedron_ply_binary<double>(false)},
        std::pair{"be64.ply", tetrahedron_ply_binary<double>(true)},
        std::pair{"ascii.stl", tetrahedron_stl_ascii()}, std::pair{"binary.Stl", tetrahedron_stl_binary()},
        std::pair{"22.msh", tetrahedron_msh_22()}, std::pair{"22b.msh", tetrahedron_msh_22_binary()},
        std::pair{"41.msh", tetrahedron_msh_41()}, std::pair{"41b.msh", tetrahedron_msh_41_binary()},
        std::pair{"ascii.vtk", tetrahedron_vtk_ascii()}, std::pair{"binary.vtk", tetrahedron_vtk_binary()},
        std::pair{"ascii.vtu", tetrahedron_vtu_ascii()}, std::pair{"raw.VTU", tetrahedron_vtu_appended()},
        std::pair{"ascii.vtp", tetrahedron_vtp_ascii()}));

TEST(read_mesh, splits_a_concave_polygon_round_its_inner_corner) {
  const TriangleMesh mesh = parse_mesh("v 0 0 0\nv 2 0 0\nv 0.1 0.1 0\nv 0 2 0\nf 2 3 4 1\n", "a.obj");

  EXPECT_EQ(mesh.triangles, (std::vector<std::array<int, 3>>{{2, 3, 0}, {2, 0, 1}}));
  EXPECT_DOUBLE_EQ(surface_area(mesh), 0.2);
  EXPECT_EQ(mesh.fans, (std::vector<std::array<int, 2>>{{0, 2}}));
}

TEST(read_mesh, counts_back_from_the_vertices_so_far_and_goes_on_behind_a_backslash) {
  const TriangleMesh mesh = parse_mesh(
      "\xEF\xBB\xBFv 0 0 0\nv 1 0 0\nv 0 1 0\n# C:\\\nf -3 -2 \\\n-1 # last\nv 0 0 1\nv 1 0 1\nv 0 1 "
      "1\nf\t-3\t-2\t-1\r\n",
      "a.obj");

  EXPECT_EQ(mesh.triangles, (std::vector<std::array<int, 3>>{{0, 1, 2}, {3, 4, 5}}));
}

TEST(read_mesh, leaves_out_the_sides_of_tetrahedra_in_files_of_gmsh_and_says_so) {
  const std::string nodes =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n2000000000 9 9 "
      "9\n$EndNodes\n";
  const std::string elements =
      "$Elements\n4\n1 15 0 1\n2 1 0 1 2\n3 2 0 1 3 2\n4 4 0 1 2 3 4\n$EndElements\n";

  const auto [mesh, objects, notes] = parse_mesh_file(nodes + elements, "a.msh");
  const TriangleMesh with_skin = parse_mesh_file(nodes + elements, "a.msh", {true, {}, ""}).mesh;

  EXPECT_EQ(mesh.n_vertices(), 4);
  EXPECT_EQ(mesh.tetrahedra.size(), 1u);
  EXPECT_TRUE(mesh.triangles.empty() && mesh.segments.empty());
  EXPECT_EQ(with_skin.triangles.size(), 1u);
  EXPECT_TRUE(objects.empty());
  EXPECT_EQ(notes.size(), 4u);
  EXPECT_EQ(notes[0], "a line that is a side of another cell: 1 left out, the first at a.msh: element 2");
}

TEST(read_mesh, splits_a_convex_polygon_into_a_fan) {
  const TriangleMesh mesh = parse_mesh("v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nf 1 2 3 4 5\n", "a.obj");

  EXPECT_EQ(mesh.triangles, (std::vector<std::array<int, 3>>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
  EXPECT_DOUBLE_EQ(surface_area(mesh), 3.0);
}

TEST(read_mesh, keeps_lone_edges_of_obj_and_ply) {
  const TriangleMesh obj = parse_mesh("v 0 0 0\nv 1 0 0\nv 2 0 0\nl 1 2 3\n", "a.obj");
  const TriangleMesh ply = parse_mesh(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
      "element edge 2\nproperty int vertex1\nproperty int vertex2\nend_header\n0 0 0\n1 0 0\n2 0 0\n0 1\n1 "
      "2\n",
      "a.ply");

  EXPECT_EQ(obj.segments, (std::vector<std::array<int, 2>>{{0, 1}, {1, 2}}));
  EXPECT_EQ(ply.segments, obj.segments);
}

TEST(read_mesh, keeps_every_bit_of_a_double) {
  const TriangleMesh mesh = parse_mesh("v 0.1 1e-300 0.30000000000000004\n", "a.obj");

  EXPECT_EQ(mesh.vertices.col(0), Vec3d(0.1, 1e-300, 0.30000000000000004));
}

TEST(read_mesh, reads_past_unknown_ply_elements) {
  const TriangleMesh mesh = parse_mesh(
      "ply\nformat ascii 1.0\nelement material 1\nproperty list uchar float shades\nelement vertex 1\n"
      "property float x\nproperty float y\nproperty float z\nend_header\n2 0.5 0.25\n4 5 6\n",
      "a.ply");

  EXPECT_EQ(mesh.vertices.col(0), Vec3d(4, 5, 6));
}

TEST(read_mesh, merges_stl_corners_only_when_they_are_equal) {
  std::string text = tetrahedron_stl_ascii();
  text.replace(text.find("vertex 1.0"), 15, "vertex 1.0000001");

  const TriangleMesh mesh = parse_mesh(text, "a.stl");

  EXPECT_EQ(mesh.n_vertices(), 5);
}

TEST(read_mesh, reads_the_meshes_of_the_test_data) {
  const std::filesystem::path meshes = optional_data("meshes");
  if (!std::filesystem::exists(meshes)) GTEST_SKIP() << "no test data at " << meshes;

  const TriangleMesh cube = read_mesh(meshes / "cube.ply");
  EXPECT_EQ(cube.n_vertices(), 8);
  EXPECT_EQ(cube.triangles.size(), 12u);
  EXPECT_TRUE(boundary_edges(cube.triangles).empty());
  EXPECT_EQ(read_mesh(meshes / "cloth_ball92.ply").n_vertices(), 46598);
  EXPECT_GT(read_mesh(meshes / "bunny.ply").triangles.size(), 1000u);
}

}  // namespace
}  // namespace bb
