// Objects (o) and groups (g) of OBJ files: which faces, lines and vertices each name has, and meshes of some of them alone.
#include <gtest/gtest.h>

#include "core/math/error.hpp"
#include "core/mesh/frame_mesh.hpp"
#include "core/mesh/read_mesh.hpp"

namespace bb {
namespace {

// Two squares that share an edge, of vertices 3 to 8; a triangle of no object before the first o; a line.
const std::string vertices =
    "v 0 0 9\nv 1 0 9\nv 0 1 9\n"                             // 1 to 3: the triangle
    "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\n"  // 4 to 9: the squares
    "v 0 0 5\nv 1 0 5\n"                                      // 10 and 11: the line
    "v 7 7 7\n";                                              // 12: of no cell
const std::string squares = vertices +
                            "f 1 2 3\n"
                            "o left half\nf 4 5 8 7\n"
                            "o right\nf 5 6 9\ng top all\nf 5 9 8\n"
                            "o line\nl 10 11\n"
                            "o empty\n";

std::vector<std::string> names_of(const std::vector<MeshObject>& objects) {
  std::vector<std::string> out;
  for (const MeshObject& object : objects) out.push_back(object.name);
  return out;
}

using Names = std::vector<std::string>;
using Numbers = std::vector<int>;
using Faces = std::vector<std::array<int, 3>>;

std::string refusal(const std::string& bytes, const MeshChoice& choice, const std::string& name = "a.obj") {
  try {
    parse_mesh_file(bytes, name, choice);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(MeshObjects, HaveTheVerticesOfTheirFacesAndLines) {
  const MeshFile file = parse_mesh_file(squares, "a.obj");

  EXPECT_EQ(file.mesh.n_vertices(), 12);
  EXPECT_EQ(file.mesh.triangles.size(), 5u);  // the face of no object is of the mesh
  ASSERT_EQ(names_of(file.objects), (Names{"left half", "right", "top", "all", "line"}));
  EXPECT_EQ(file.objects[0].vertices, (Numbers{3, 4, 6, 7}));
  EXPECT_EQ(file.objects[0].faces, 1);                         // a square, cut into two triangles
  EXPECT_EQ(file.objects[1].vertices, (Numbers{4, 5, 7, 8}));  // 4 and 7 are of both squares
  EXPECT_EQ(file.objects[1].faces, 2);
  EXPECT_EQ(file.objects[2].vertices, (Numbers{4, 7, 8}));
  EXPECT_EQ(file.objects[3].vertices, file.objects[2].vertices);
  EXPECT_EQ(file.objects[4].vertices, (Numbers{9, 10}));
  EXPECT_EQ(file.objects[4].lines, 1);
}

TEST(MeshObjects, OfOneNameAreOneAndAnObjectEndsTheGroupsBeforeIt) {
  const MeshFile file = parse_mesh_file(
      vertices + "g a\nf 4 5 8\no b\nf 4 8 7\no a\nf 5 6 9\ng\nf 5 9 8\no\nf 1 2 3\n", "a.obj");

  ASSERT_EQ(names_of(file.objects), (Names{"a", "b"}));
  EXPECT_EQ(file.objects[0].vertices, (Numbers{3, 4, 5, 7, 8}));
  EXPECT_EQ(file.objects[0].faces, 3);  // of the group and of the object of that name
  EXPECT_EQ(file.objects[1].vertices, (Numbers{3, 6, 7}));
}

TEST(MeshObjects, AreMeshesOfTheirOwn) {
  const MeshFile right = parse_mesh_file(squares, "a.obj", {false, {"right"}, ""});
  EXPECT_EQ(right.mesh.triangles, (Faces{{0, 1, 3}, {0, 3, 2}}));  // of vertices 5, 6, 8 and 9
  EXPECT_EQ(right.mesh.n_vertices(), 4);
  EXPECT_EQ(right.mesh.vertices.col(0), Vec3d(1, 0, 0));
  EXPECT_EQ(right.mesh.vertices.col(3), Vec3d(2, 1, 0));
  EXPECT_TRUE(right.mesh.segments.empty());
  ASSERT_EQ(names_of(right.objects), (Names{"right", "top", "all"}));  // what is left of the others
  EXPECT_EQ(right.objects[1].vertices, (Numbers{0, 2, 3}));
  EXPECT_EQ(right.notes[0], "a face of another object: 2 left out, the first at a.obj:13");

  const MeshFile left = parse_mesh_file(squares, "a.obj", {false, {"left half"}, ""});
  EXPECT_EQ(left.mesh.n_vertices(), 4);
  EXPECT_EQ(left.mesh.triangles.size(), 2u);
  EXPECT_EQ(left.mesh.fans, (std::vector<std::array<int, 2>>{{0, 2}}));

  const MeshFile both = parse_mesh_file(squares, "a.obj", {false, {"line", "left half", "top", "top"}, ""});
  EXPECT_EQ(both.mesh.n_vertices(), 7);
  EXPECT_EQ(both.mesh.triangles.size(), 3u);
  EXPECT_EQ(both.mesh.segments, (std::vector<std::array<int, 2>>{{5, 6}}));
}

TEST(MeshObjects, ThatAreUnknownAreRefusedWithTheNamesThereAre) {
  EXPECT_EQ(
      refusal(squares, {false, {"right", "empty"}, "c.json#/mesh/objects"}),
      "c.json#/mesh/objects: found \"empty\", which no face or line of a.obj has; allowed: one of left half, "
      "right, top, all, line");
  EXPECT_EQ(refusal(vertices + "f 1 2 3\n", {false, {"a"}, ""}),
            "a.obj: found \"a\", which no face or line of a.obj has; allowed: a mesh file with objects (o) "
            "or groups "
            "(g), which OBJ files can have");
  const std::string stl =
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
      "endsolid a\n";
  EXPECT_NE(refusal(stl, {false, {"a"}, ""}, "a.stl").find("a mesh file with objects"), std::string::npos);
  std::string many = vertices;
  for (int i = 0; i < 30; ++i) many += "o n" + std::to_string(i) + "\nl 10 11\n";
  EXPECT_NE(refusal(many, {false, {"x"}, ""}).find("n18, n19, and 10 more"), std::string::npos);
}

TEST(MeshObjects, WithAWrongCornerAreRefusedByTheLineOfTheFile) {
  const std::string wrong = refusal(vertices + "o a\nf 1 2 3\no b\nf 4 5 99\n", {false, {"b"}, ""});
  EXPECT_NE(wrong.find("a.obj:16: found vertex 99; allowed: a vertex from 1 to 12"), std::string::npos)
      << wrong;
}

TEST(MeshObjects, AreThoseOfAFrameToo) {
  EXPECT_EQ(names_of(parse_frame(squares, "a.obj").objects),
            names_of(parse_mesh_file(squares, "a.obj").objects));
}

}  // namespace
}  // namespace bb
