// Writers: what is written reads back bit for bit, and nothing half-written stays.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/math/error.hpp"
#include "core/mesh/generators.hpp"
#include "core/mesh/read_mesh.hpp"
#include "core/mesh/write_mesh.hpp"
#include "tests/temporary_folder.hpp"

namespace bb {
namespace {

TriangleMesh sphere_with_a_tail() {
  TriangleMesh mesh = icosphere_mesh(1, 0.3);
  mesh.segments = {{0, 41}, {41, 7}};
  return mesh;
}

class Written : public ::testing::TestWithParam<const char*> {};

TEST_P(Written, reads_back_bit_for_bit) {
  const TriangleMesh mesh = sphere_with_a_tail();
  const test::TemporaryFolder folder;
  const std::string path = folder / (std::string("written") + GetParam());

  if (std::string(GetParam()) == ".obj") {
    write_obj(path, mesh);
  } else {
    std::ofstream(path, std::ios::binary) << ply_bytes(mesh);
  }
  const TriangleMesh back = read_mesh(path);

  EXPECT_EQ(back.vertices, mesh.vertices);
  EXPECT_EQ(back.triangles, mesh.triangles);
  EXPECT_EQ(back.segments, mesh.segments);
}
INSTANTIATE_TEST_SUITE_P(write_mesh, Written, ::testing::Values(".obj", ".ply"));

TEST(write_mesh, columns_stand_beside_what_is_read_back) {
  const TriangleMesh mesh = sphere_with_a_tail();
  std::vector<int> bodies(42);
  std::vector<double> stretch(80);
  for (std::size_t i = 0; i < bodies.size(); ++i) bodies[i] = static_cast<int>(i) - 7;
  for (std::size_t i = 0; i < stretch.size(); ++i) stretch[i] = 0.25 * static_cast<double>(i);
  const std::string bytes =
      ply_bytes(mesh, {{"body", bodies}}, {{"body", std::vector<int>(80, 3)}, {"stretch", stretch}});
  const test::TemporaryFolder folder;
  const std::string path = folder / "columns.ply";

  std::ofstream(path, std::ios::binary) << bytes;
  const TriangleMesh back = read_mesh(path);

  EXPECT_EQ(back.vertices, mesh.vertices);
  EXPECT_EQ(back.triangles, mesh.triangles);
  EXPECT_EQ(back.segments, mesh.segments);
  EXPECT_NE(bytes.find("property double z\nproperty int body\nelement face 80\n"), std::string::npos);
  EXPECT_EQ(bytes.size() - ply_bytes(mesh).size(), 42 * 4 + 80 * (4 + 8) +
                                                       std::string("property int body\n").size() * 2 +
                                                       std::string("property double stretch\n").size());
}

TEST(write_mesh, says_why_a_file_cannot_be_written) {
  EXPECT_THROW(write_obj("/no/such/folder/a.obj", sphere_with_a_tail()), ConfigError);
}

TEST(write_mesh, leaves_nothing_half_written) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directory(folder / "taken.obj");  // a folder stands where the file should

  EXPECT_THROW(write_obj(folder / "taken.obj", sphere_with_a_tail()), ConfigError);

  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
}

}  // namespace
}  // namespace bb
