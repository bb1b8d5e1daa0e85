// Objects (o) and groups (g) of OBJ files: which faces, lines and vertices each name has, and meshes of some of them alone.
#include <gtest/gtest.h>

#include "core/math/error.hpp"
#include "core/model/mesh/frame_mesh.hpp"
#include "core/model/mesh/read_mesh.hpp"

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

std::vector<std::string> names_of(const MeshObjects& objects) {
  std::vector<std::string> out;
  for (const MeshObject& object : objects.list) out.push_back(object.name);
  return out;
}

using Names = std::vector<std::string>;
using Numbers = std::vector<int>;
std::vector<int> vertices_of(const MeshFile& file, std::size_t i) {
  return file.objects.file_vertices(file.objects.list[i]);
}

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
  EXPECT_EQ(vertices_of(file, 0), (Numbers{3, 4, 6, 7}));
  EXPECT_EQ(file.objects.list[0].faces, 1);                // a square, cut into two triangles
  EXPECT_EQ(vertices_of(file, 1), (Numbers{4, 5, 7, 8}));  // 4 and 7 are of both squares
  EXPECT_EQ(file.objects.list[1].faces, 2);
  EXPECT_EQ(vertices_of(file, 2), (Numbers{4, 7, 8}));
  EXPECT_EQ(vertices_of(file, 3), vertices_of(file, 2));
  EXPECT_EQ(vertices_of(file, 4), (Numbers{9, 10}));
  EXPECT_EQ(file.objects.list[4].lines, 1);
}

TEST(MeshObjects, OfOneNameAreOneAndAnObjectEndsTheGroupsBeforeIt) {
  const MeshFile file = parse_mesh_file(
      vertices + "g a\nf 4 5 8\no b\nf 4 8 7\no a\nf 5 6 9\ng\nf 5 9 8\no\nf 1 2 3\n", "a.obj");

  ASSERT_EQ(names_of(file.objects), (Names{"a", "b"}));
  EXPECT_EQ(vertices_of(file, 0), (Numbers{3, 4, 5, 7, 8}));
  EXPECT_EQ(file.objects.list[0].faces, 3);  // of the group and of the object of that name
  EXPECT_EQ(vertices_of(file, 1), (Numbers{3, 6, 7}));
}

TEST(MeshObjects, AreMeshesOfTheirOwn) {
  const MeshFile right = parse_mesh_file(squares, "a.obj", {false, {"right"}, ""});
  EXPECT_EQ(right.mesh.triangles, (Faces{{0, 1, 3}, {0, 3, 2}}));  // of vertices 5, 6, 8 and 9
  EXPECT_EQ(right.mesh.n_vertices(), 4);
  EXPECT_EQ(right.mesh.vertices.col(0), Vec3d(1, 0, 0));
  EXPECT_EQ(right.mesh.vertices.col(3), Vec3d(2, 1, 0));
  EXPECT_TRUE(right.mesh.segments.empty());
  ASSERT_EQ(names_of(right.objects), (Names{"left half", "right", "top", "all", "line"}));  // of the file
  EXPECT_EQ(right.objects.mesh_vertices(right.objects.list[0]), (Numbers{0, 2}));  // 5 and 8 are shared
  EXPECT_EQ(right.objects.mesh_vertices(right.objects.list[2]), (Numbers{0, 2, 3}));
  EXPECT_EQ(right.objects.mesh_vertices(right.objects.list[4]), Numbers{});
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
  EXPECT_EQ(refusal(squares, {false, {"right", "empty"}, "c.json#/mesh/objects"}),
            "c.json#/mesh/objects/1: found \"empty\", which no face or line of a.obj has; allowed: one of "
            "left half, "
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

TEST(MeshObjects, HaveTheirNamesAsTheyStandInTheFile) {
  const auto names = [](const std::string& lines) {
    return names_of(parse_mesh_objects(vertices + lines, "a.obj"));
  };
  EXPECT_EQ(names("o shirt #1\nl 1 2\no shirt #2\r\nl 2 3\no #part\t\nl 3 4\n"),
            (Names{"shirt #1", "shirt #2", "#part"}));
  EXPECT_EQ(names("  o   a  b \nl 1 2\no long\\\n  name\nl 2 3\n"), (Names{"a  b", "long name"}));
  EXPECT_EQ(names("o caf\xe9\nl 1 2\no caf\xc3\xa9\nl 2 3\ng \xfc # a comment\nl 3 4\n"),
            (Names{"caf\xc3\xa9", "\xc3\xbc"}));
}

TEST(MeshObjects, OfAGroupThatStandsBeforeAnObjectGoOn) {
  const MeshFile file = parse_mesh_file(
      vertices + "g cloth\no first\nf 4 5 8\no second\nf 4 8 7\ng late\nv 9 9 9\no third\nf 5 6 9\n",
      "a.obj");
  ASSERT_EQ(names_of(file.objects), (Names{"cloth", "first", "second", "third"}));
  EXPECT_EQ(vertices_of(file, 0), (Numbers{3, 4, 7}));
}

TEST(MeshObjects, OfManyNamesHoldEachSetOfNamesOnce) {
  std::string bytes = vertices + "g";
  for (int i = 0; i < 40000; ++i) bytes += " n" + std::to_string(i);
  bytes += '\n';
  for (int i = 0; i < 5000; ++i) bytes += "l 4 5\nl 5 6\n";
  bytes += "g n0\nl 10 11\n";
  const MeshObjects objects = parse_mesh_objects(bytes, "a.obj");

  ASSERT_EQ(objects.list.size(), 1000u);  // of one g line
  std::size_t held = 0, sets = 0;
  for (const std::vector<int>& set : objects.set_vertices) held += set.size();
  for (const MeshObject& object : objects.list) sets += object.sets.size();
  EXPECT_EQ(held, 5u);  // 4 to 6, and 10 and 11
  EXPECT_EQ(sets, 1001u);
  EXPECT_EQ(objects.file_vertices(objects.list[0]), (Numbers{3, 4, 5, 9, 10}));
  EXPECT_EQ(objects.file_vertices(objects.list[999]), (Numbers{3, 4, 5}));
  EXPECT_EQ(objects.list[999].lines, 10000);
  EXPECT_EQ(
      parse_frame(bytes, "a.obj").notes,
      Names{"a name of a group behind the first 1000 of its line: 39000 left out, the first at a.obj:13"});
}

TEST(MeshObjects, OfOneSetOfNamesInManyPlacesAreHeldOnce) {
  std::string bytes = vertices;
  for (int i = 0; i < 100; ++i) bytes += "g a b\nl 4 5\ng b a\nl 5 6\ng c\n";
  const MeshObjects objects = parse_mesh_objects(bytes, "a.obj");
  ASSERT_EQ(objects.set_vertices.size(), 1u);
  EXPECT_EQ(objects.set_vertices[0], (Numbers{3, 4, 5}));
}

}  // namespace
}  // namespace bb
