// The writer: what is written reads back bit for bit.
#include <gtest/gtest.h>

#include "core/model/mesh/generators.hpp"
#include "core/model/mesh/read_mesh.hpp"
#include "core/model/mesh/write_mesh.hpp"

namespace bb {
namespace {

TriangleMesh sphere_with_a_tail() {
  TriangleMesh mesh = icosphere_mesh(1, 0.3);
  mesh.segments = {{0, 41}, {41, 7}};
  return mesh;
}

TEST(write_mesh, reads_back_bit_for_bit) {
  const TriangleMesh mesh = sphere_with_a_tail();

  const TriangleMesh back = parse_mesh(ply_bytes(mesh), "sphere.ply");

  EXPECT_EQ(back.vertices, mesh.vertices);
  EXPECT_EQ(back.triangles, mesh.triangles);
  EXPECT_EQ(back.segments, mesh.segments);
}

TEST(write_mesh, columns_stand_beside_what_is_read_back) {
  const TriangleMesh mesh = sphere_with_a_tail();
  std::vector<int> bodies(42);
  std::vector<double> stretch(80);
  for (std::size_t i = 0; i < bodies.size(); ++i) bodies[i] = static_cast<int>(i) - 7;
  for (std::size_t i = 0; i < stretch.size(); ++i) stretch[i] = 0.25 * static_cast<double>(i);
  const std::string bytes =
      ply_bytes(mesh, {{"body", bodies}}, {{"body", std::vector<int>(80, 3)}, {"stretch", stretch}});

  const TriangleMesh back = parse_mesh(bytes, "columns.ply");

  EXPECT_EQ(back.vertices, mesh.vertices);
  EXPECT_EQ(back.triangles, mesh.triangles);
  EXPECT_EQ(back.segments, mesh.segments);
  EXPECT_NE(bytes.find("property double z\nproperty int body\nelement face 80\n"), std::string::npos);
  EXPECT_EQ(bytes.size() - ply_bytes(mesh).size(), 42 * 4 + 80 * (4 + 8) +
                                                       std::string("property int body\n").size() * 2 +
                                                       std::string("property double stretch\n").size());
}

}  // namespace
}  // namespace bb
