// Gaps of the whole surface against dense samples, with thickness.
#include "core/audit/surface_gap.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/audit/closest_point.hpp"
#include "core/audit/state_audit.hpp"
#include "core/audit/surface_edges.hpp"
#include "tests/audit/small_scenes.hpp"

namespace bb::audit::surface_gap_test {
namespace {

/// Two triangles of random shape about 0.9 apart, every side an edge.
struct Pair {
  AuditMesh mesh;
  Positions x;
};

Pair random_pair(std::mt19937& random) {
  std::uniform_real_distribution<double> c(-0.5, 0.5);
  Pair out;
  out.mesh = two_triangles();
  out.x.resize(3, 6);
  for (int v = 0; v < 6; ++v) out.x.col(v) = Vec3d(c(random), c(random), c(random) + (v < 3 ? 0.0 : 0.9));
  return out;
}

std::vector<Vec3d> samples(const Positions& x, int first, int n) {
  std::vector<Vec3d> out;
  for (int p = 0; p <= n; ++p) {
    for (int q = 0; q <= n - p; ++q) {
      out.push_back(x.col(first) + p / double(n) * (x.col(first + 1) - x.col(first)) +
                    q / double(n) * (x.col(first + 2) - x.col(first)));
    }
  }
  return out;
}

SurfaceGap gap_of(const Pair& pair, double reach) {
  return surface_gap(pair.mesh, colliding_vertices(pair.mesh), obstacle_primitives(pair.mesh), pair.x, reach);
}

TEST(SurfaceGap, between_triangles_agrees_with_dense_samples) {
  std::mt19937 random(4);
  int apart = 0;
  for (int i = 0; i < 300; ++i) {
    Pair pair = random_pair(random);
    if (audit_state(pair.mesh, pair.x, true).crossings > 0) continue;
    const double gap = gap_of(pair, 10.0).between;
    double least = 1e9;
    const std::vector<Vec3d> first = samples(pair.x, 0, 24), second = samples(pair.x, 3, 24);
    for (const Vec3d& p : first) {
      for (const Vec3d& q : second) least = std::min(least, (p - q).norm());
    }
    ASSERT_LE(gap, least + 1e-12);
    ASSERT_GT(gap, least - 0.06);
    ++apart;
    pair.mesh.thickness.assign(6, 0.1);
    EXPECT_NEAR(gap_of(pair, 10.0).between, gap - 0.2, 1e-12);
    EXPECT_TRUE(std::isinf(gap_of(pair, gap - 0.2 - 1e-9).between)) << "out of reach";
    EXPECT_TRUE(std::isfinite(gap_of(pair, gap - 0.2 + 1e-9).between));
  }
  EXPECT_GT(apart, 200);
}

TEST(SurfaceGap, to_obstacles_takes_the_whole_surface) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> c(-1, 1);
  int hidden = 0;
  for (int i = 0; i < 300; ++i) {
    Pair pair = random_pair(random);
    const Vec3d centre(c(random), c(random), c(random)), axis(c(random), c(random), 1.0);
    pair.mesh.obstacles = {{i % 2 ? ObstacleKind::sphere : ObstacleKind::cylinder, centre, axis, 0.1, false}};
    const double gap = gap_of(pair, 1.0).to_obstacles;
    double least = 1e9, of_vertices = 1e9;
    for (const int first : {0, 3}) {
      for (const Vec3d& p : samples(pair.x, first, 40)) {
        Vec3d w = p - centre;
        if (i % 2 == 0) w -= axis * (axis.dot(w) / axis.squaredNorm());
        least = std::min(least, w.norm() - 0.1);
      }
    }
    for (int v = 0; v < 6; ++v) {
      Vec3d w = pair.x.col(v) - centre;
      if (i % 2 == 0) w -= axis * (axis.dot(w) / axis.squaredNorm());
      of_vertices = std::min(of_vertices, w.norm() - 0.1);
    }
    ASSERT_LE(gap, least + 1e-12);
    ASSERT_GT(gap, least - 0.05);
    hidden += gap < of_vertices - 0.1;
    pair.mesh.thickness.assign(6, 0.02);
    EXPECT_NEAR(gap_of(pair, 1.0).to_obstacles, gap - 0.02, 1e-12);
  }
  EXPECT_GT(hidden, 20);
}

TEST(SurfaceGap, planes_and_insides_take_vertices_and_nothing_there_is_infinite) {
  std::mt19937 random(9);
  Pair pair = random_pair(random);
  EXPECT_TRUE(std::isinf(gap_of(pair, 1.0).to_obstacles));
  pair.mesh.obstacles = {{ObstacleKind::plane, Vec3d(0, 0, -2), Vec3d(0, 0, 3), 0.0, false}};
  EXPECT_NEAR(gap_of(pair, 1.0).to_obstacles, pair.x.row(2).minCoeff() + 2, 1e-12);
  pair.mesh.obstacles = {{ObstacleKind::sphere, Vec3d::Zero(), Vec3d::UnitZ(), 3.0, true}};
  EXPECT_NEAR(gap_of(pair, 1.0).to_obstacles, 3 - pair.x.colwise().norm().maxCoeff(), 1e-12);
  pair.mesh.prescribed.assign(6, 1);
  EXPECT_TRUE(std::isinf(gap_of(pair, 1.0).to_obstacles)) << "what is given is no matter of the solver";
}

TEST(ClosestPoint, segments_agree_with_samples_and_need_no_length) {
  std::mt19937 random(2);
  std::uniform_int_distribution<int> c(-2, 2);
  int parallel = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto point = [&] { return Vec3d(c(random), c(random), c(random)); };
    const Vec3d p = point(), q = point(), a = point(), b = point();
    parallel += (q - p).cross(b - a).isZero();
    double least = 1e9;
    for (int s = 0; s <= 60; ++s) {
      for (int t = 0; t <= 60; ++t)
        least = std::min(least, (p + s / 60.0 * (q - p) - a - t / 60.0 * (b - a)).norm());
    }
    ASSERT_LE(segment_distance(p, q, a, b), least + 1e-12);
    ASSERT_GT(segment_distance(p, q, a, b), least - 0.12);
  }
  EXPECT_GT(parallel, 30);
}

TEST(SurfaceGap, of_each_vertex_is_that_of_its_closest_triangle) {
  std::mt19937 random(5);
  int finite = 0;
  for (int i = 0; i < 100; ++i) {
    const Pair pair = random_pair(random);
    const std::vector<int> all = colliding_vertices(pair.mesh);
    const std::vector<double> gaps = gap_of(pair, 0.8).of_vertices;
    ASSERT_EQ(gaps.size(), 6u);
    for (const int v : all) {
      double least = 1e9;
      for (const Vec3d& p : samples(pair.x, v < 3 ? 3 : 0, 40))
        least = std::min(least, (p - pair.x.col(v)).norm());
      const double gap = gaps[static_cast<std::size_t>(v)];
      if (std::isinf(gap)) {
        EXPECT_GE(least, 0.8);
        continue;
      }
      EXPECT_LE(gap, least + 1e-12);
      EXPECT_GT(gap, least - 0.05);
      ++finite;
    }
  }
  EXPECT_GT(finite, 100);
}

}  // namespace
}  // namespace bb::audit::surface_gap_test
