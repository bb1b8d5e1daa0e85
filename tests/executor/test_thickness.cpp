// Thick surfaces near balls and bars on an executor: a row begins where the gap between the surfaces, thickness taken
// off, is d_hat, which is farther from the middle surface than d_hat.
#include <gtest/gtest.h>

#include "tests/contact/rods.hpp"
#include "tests/executor/rows_pair_by_pair.hpp"
#include "tests/executor/tested_executor.hpp"

namespace bb::test::executor_thickness_test {
namespace {

constexpr double d_hat = 0.08, radius = 0.5;

Obstacle obstacle(ObstacleKind kind, const Vec3d& point, const Vec3d& axis) {
  Obstacle out;
  out.kind = kind, out.point = point, out.axis = axis, out.radius = radius;
  return out;
}

/// Of all kinds of rows that a scene has on the CPU path; on an executor it has the same.
std::array<int, 8> kinds_of(const Scene& scene) {
  std::array<int, 8> out{};
  ContactSystem contacts(scene, {});
  TestedExecutor executor;
  OnExecutor on(executor, scene, scene.x0);
  compare(scene, on.rows, rows_at(contacts, scene.x0), out);
  return out;
}

/// Triangles that lie on a ball and on a bar with gaps up to 0.9 d_hat, by their faces, edges and corners.
TEST(ExecutorThickness, TrianglesNearBallsAndBarsHaveTheRowsOfTheCpuPath) {
  const Vec3d along = Vec3d(2, 1, -2) / 3.0;
  for (const double offset : {0.0, 0.01, 0.05, 0.2}) {
    std::array<int, 8> n_kinds{};
    for (unsigned seed = 1; seed <= 4; ++seed) {
      Scene scene;
      add_tangent_triangles(scene, "on ball", Vec3d::Zero(), radius, Vec3d::Zero(), d_hat, seed, offset);
      add_tangent_triangles(scene, "on bar", Vec3d(9, 0, 0), radius, along, d_hat, seed, offset);
      scene.obstacles = {obstacle(ObstacleKind::sphere, Vec3d::Zero(), Vec3d::UnitZ()),
                         obstacle(ObstacleKind::cylinder, Vec3d(9, 0, 0), along)};
      const std::array<int, 8> kinds = kinds_of(scene);
      for (std::size_t k = 0; k < kinds.size(); ++k) n_kinds[k] += kinds[k];
    }
    int rows = 0;
    for (const int n : n_kinds) rows += n;
    EXPECT_GT(rows, 60) << offset;
  }
}

/// One sheet or rod above the top of a ball or a bar, its middle closest: on either side of d_hat.
TEST(ExecutorThickness, ARowBeginsAtDHatFromTheThickSurface) {
  for (const ObstacleKind kind : {ObstacleKind::sphere, ObstacleKind::cylinder}) {
    for (const bool rod : {false, true}) {
      for (const double offset : {0.0, 0.01, 0.05, 0.2}) {
        for (const double part : {0.1, 0.5, 0.9, 0.999, 1.001, 1.2}) {
          const double z = radius + offset + part * d_hat;
          Scene scene;
          if (rod) {
            add_rod(scene, Vec3d(-0.4, 0.02, z), Vec3d(0.8, -0.04, 0), 1, d_hat, offset);
          } else {
            const std::vector<Vec3d> corners = {Vec3d(-0.5, -0.4, z), Vec3d(0.6, -0.4, z),
                                                Vec3d(0.05, 0.7, z)};
            add_body(scene, "sheet", corners, {{0, 1, 2}}, d_hat, false, offset);
          }
          scene.obstacles = {obstacle(kind, Vec3d::Zero(), Vec3d::UnitY())};
          int rows = 0;
          for (const int n : kinds_of(scene)) rows += n;
          EXPECT_EQ(rows > 0, part < 1) << part << " " << offset << (rod ? " rod" : " sheet");
        }
      }
    }
  }
}

/// Between two bodies thickness counts twice, once of each.
TEST(ExecutorThickness, PairsOfThickBodiesHaveTheRowsOfTheCpuPath) {
  for (const double offset : {0.0, 0.02, 0.1}) {
    for (const double part : {0.3, 0.999, 1.001}) {
      Scene scene;
      const auto [vertices, triangles] = grid(2, 2, 1.0);
      add_body(scene, "lower", vertices, triangles, d_hat, false, offset);
      const double z = 2 * offset + part * d_hat;
      const auto [above, faces] = grid(2, 2, 0.9, Vec3d(0.011, 0.017, z));
      add_body(scene, "upper", above, faces, d_hat, false, offset);
      int rows = 0;
      for (const int n : kinds_of(scene)) rows += n;
      EXPECT_EQ(rows > 0, part < 1) << part << " " << offset;
    }
  }
}

}  // namespace
}  // namespace bb::test::executor_thickness_test
