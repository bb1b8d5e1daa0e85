// Generators: counts, areas, Euler characteristic, orientation.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math/error.hpp"
#include "core/model/mesh/generators.hpp"
#include "core/model/mesh/topology.hpp"

namespace bb {
namespace {

long euler(const TriangleMesh& mesh) {
  return mesh.n_vertices() - static_cast<long>(unique_edges(mesh).size()) +
         static_cast<long>(mesh.triangles.size());
}

double enclosed_volume(const TriangleMesh& mesh) {
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    volume += mesh.vertices.col(t[0]).dot(mesh.vertices.col(t[1]).cross(mesh.vertices.col(t[2]))) / 6;
  }
  return volume;
}

/// Every edge has two triangles that run through it in opposite directions.
void expect_closed_and_oriented(const TriangleMesh& mesh) {
  EXPECT_TRUE(boundary_edges(mesh.triangles).empty());
  EXPECT_EQ(2 * edge_hinges(mesh.triangles).size(), 3 * mesh.triangles.size());
  for (const auto& h : edge_hinges(mesh.triangles)) {
    const bool opposite = std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& t) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (t[k] == h[1] && t[(k + 1) % 3] == h[0] && t[(k + 2) % 3] == h[3]) return true;
      }
      return false;
    });
    EXPECT_TRUE(opposite) << "edge " << h[0] << " " << h[1];
  }
}

TEST(grid_mesh, has_the_counts_the_area_and_the_diagonals_of_the_article) {
  const TriangleMesh mesh = grid_mesh(4, 3, 3.0, 1.0);

  EXPECT_EQ(mesh.n_vertices(), 12);
  EXPECT_EQ(mesh.triangles.size(), 12u);
  EXPECT_EQ(euler(mesh), 1);
  EXPECT_NEAR(surface_area(mesh), 3.0, 1e-15);
  EXPECT_EQ(mesh.vertices.col(0), Vec3d(-1.5, -0.5, 0));
  EXPECT_EQ(mesh.vertices.col(11), Vec3d(1.5, 0.5, 0));
  EXPECT_EQ(mesh.triangles[0], (std::array<int, 3>{0, 1, 5}));  // a b d
  EXPECT_EQ(mesh.triangles[1], (std::array<int, 3>{0, 5, 4}));  // a d c
  EXPECT_EQ(boundary_edges(mesh.triangles).size(), 10u);
  for (const auto& t : mesh.triangles) EXPECT_GT(area_vector(mesh.vertices, t)[2], 0);
}

TEST(icosphere_mesh, is_a_closed_outward_sphere_on_every_level) {
  for (int level = 0; level <= 3; ++level) {
    SCOPED_TRACE(level);
    const TriangleMesh mesh = icosphere_mesh(level, 2.0);
    EXPECT_EQ(mesh.n_vertices(), 10 * (1 << (2 * level)) + 2);
    EXPECT_EQ(euler(mesh), 2);
    expect_closed_and_oriented(mesh);
    EXPECT_LT((mesh.vertices.colwise().norm().array() - 2.0).abs().maxCoeff(), 1e-15 * 4);
    for (const auto& t : mesh.triangles)
      EXPECT_GT(area_vector(mesh.vertices, t).dot(mesh.vertices.col(t[0])), 0);
  }
  const double exact = 16 * std::numbers::pi;
  EXPECT_NEAR(surface_area(icosphere_mesh(4, 2.0)), exact, 0.005 * exact);
  EXPECT_LT(surface_area(icosphere_mesh(4, 2.0)), exact);
}

TEST(cylinder_mesh, is_closed_with_caps_and_has_two_rims_without) {
  const TriangleMesh closed = cylinder_mesh(12, 3, 0.5, 2.0, true);
  const TriangleMesh open = cylinder_mesh(12, 3, 0.5, 2.0, false);

  EXPECT_EQ(closed.n_vertices(), 12 * 4 + 2);
  EXPECT_EQ(euler(closed), 2);
  expect_closed_and_oriented(closed);
  const double polygon = 0.5 * 12 * 0.25 * std::sin(2 * std::numbers::pi / 12);
  EXPECT_NEAR(enclosed_volume(closed), 2.0 * polygon, 1e-14);
  EXPECT_EQ(euler(open), 0);
  EXPECT_EQ(boundary_edges(open.triangles).size(), 24u);
  for (const auto& t : open.triangles) {
    const Vec3d middle = (open.vertices.col(t[0]) + open.vertices.col(t[1]) + open.vertices.col(t[2])) / 3;
    EXPECT_GT(area_vector(open.vertices, t).dot(Vec3d(middle[0], middle[1], 0)), 0);
  }
}

TEST(box_mesh, is_a_closed_outward_box) {
  for (const int n : {1, 3}) {
    SCOPED_TRACE(n);
    const TriangleMesh mesh = box_mesh(n, Vec3d(1, 2, 3));
    EXPECT_EQ(mesh.n_vertices(), 6 * n * n + 2);
    EXPECT_EQ(mesh.triangles.size(), static_cast<std::size_t>(12 * n * n));
    EXPECT_EQ(euler(mesh), 2);
    expect_closed_and_oriented(mesh);
    EXPECT_NEAR(surface_area(mesh), 22.0, 1e-13);
    EXPECT_NEAR(enclosed_volume(mesh), 6.0, 1e-13);
  }
}

TEST(rod_mesh, joins_its_ends_by_equal_segments) {
  const TriangleMesh mesh = rod_mesh(4, Vec3d(-1, 0, 0), Vec3d(1, 0, 0));

  EXPECT_EQ(mesh.n_vertices(), 5);
  EXPECT_EQ(mesh.segments, (std::vector<std::array<int, 2>>{{0, 1}, {1, 2}, {2, 3}, {3, 4}}));
  EXPECT_TRUE(mesh.triangles.empty());
  EXPECT_EQ(mesh.vertices.col(1), Vec3d(-0.5, 0, 0));
  EXPECT_EQ(mesh.vertices.col(4), Vec3d(1, 0, 0));
}

TEST(ring_mesh, closes_on_a_circle_with_equal_segments) {
  const TriangleMesh mesh = ring_mesh(6, 2.0);

  EXPECT_EQ(mesh.segments, (std::vector<std::array<int, 2>>{{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 0}}));
  EXPECT_TRUE(mesh.triangles.empty());
  for (const auto& [a, b] : mesh.segments) {
    EXPECT_NEAR(mesh.vertices.col(a).norm(), 2.0, 1e-15);
    EXPECT_NEAR((mesh.vertices.col(b) - mesh.vertices.col(a)).norm(), 2.0, 1e-14);  // a hexagon
  }
}

TEST(helix_mesh, rises_by_its_pitch_every_turn) {
  const TriangleMesh mesh = helix_mesh(24, 2, 0.5, 0.3);

  EXPECT_EQ(mesh.n_vertices(), 25);
  EXPECT_EQ(mesh.segments.size(), 24u);
  EXPECT_NEAR(mesh.vertices(2, 0), -0.3, 1e-15);
  EXPECT_NEAR(mesh.vertices(2, 24), 0.3, 1e-15);
  EXPECT_LT((mesh.vertices.col(12) - mesh.vertices.col(0) - Vec3d(0, 0, 0.3)).norm(), 1e-15);
  EXPECT_LT((mesh.vertices.col(3) - Vec3d(0, 0.5, -0.3 + 0.3 / 4)).norm(), 1e-15);  // right-handed
  const double length = (mesh.vertices.col(1) - mesh.vertices.col(0)).norm();
  for (const auto& [a, b] : mesh.segments)
    EXPECT_NEAR((mesh.vertices.col(b) - mesh.vertices.col(a)).norm(), length, 1e-14);
}

TEST(generators, refuse_what_makes_no_mesh) {
  EXPECT_THROW(grid_mesh(1, 2, 1, 1), ConfigError);
  EXPECT_THROW(grid_mesh(2, 2, 0, 1), ConfigError);
  EXPECT_THROW(grid_mesh(2, 2, 1, std::nan("")), ConfigError);
  EXPECT_THROW(icosphere_mesh(9, 1), ConfigError);
  EXPECT_THROW(cylinder_mesh(2, 1, 1, 1, true), ConfigError);
  EXPECT_THROW(box_mesh(0, Vec3d(1, 1, 1)), ConfigError);
  EXPECT_THROW(rod_mesh(1, Vec3d::Zero(), Vec3d::Zero()), ConfigError);
  EXPECT_THROW(ring_mesh(2, 1), ConfigError);
  EXPECT_THROW(ring_mesh(3, 0), ConfigError);
  EXPECT_THROW(helix_mesh(0, 1, 1, 1), ConfigError);
  EXPECT_THROW(helix_mesh(8, 1, 1, -1), ConfigError);
}

}  // namespace
}  // namespace bb
