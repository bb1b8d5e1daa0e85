// Vertices inside closed bodies: against the signed distance of a convex body, rays that meet edges, and what changed.
#include "core/audit/enclosed.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/audit/small_scenes.hpp"

namespace bb::audit::enclosed_test {
namespace {

/// The cube [0, 1]^3 of 12 triangles with the vertices 0..7, and loose points from 8 on.
AuditMesh cube_and_points() {
  Eigen::Matrix3Xi t(3, 12);
  t << 0, 4, 0, 2, 0, 1, 0, 4, 0, 2, 0, 1,  //
      1, 6, 4, 3, 2, 5, 3, 7, 5, 7, 6, 7,   //
      3, 7, 5, 7, 6, 7, 2, 5, 1, 6, 4, 3;
  return surface(t);
}

Positions with_points(const std::vector<Vec3d>& points) {
  Positions x(3, 8 + static_cast<Eigen::Index>(points.size()));
  for (int v = 0; v < 8; ++v) x.col(v) = Vec3d(v >> 2, (v >> 1) & 1, v & 1);
  for (std::size_t i = 0; i < points.size(); ++i) x.col(8 + static_cast<Eigen::Index>(i)) = points[i];
  return x;
}

std::vector<int> numbers(int n) {
  std::vector<int> out;
  for (int v = 0; v < n; ++v) out.push_back(v);
  return out;
}

TEST(Enclosed, parity_agrees_with_a_convex_body) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> c(-0.4, 1.4);
  std::vector<Vec3d> points;
  for (int i = 0; i < 400; ++i) points.emplace_back(c(random), c(random), c(random));
  const AuditMesh mesh = cube_and_points();
  const Positions x = with_points(points);
  const ClosedBodies closed(mesh, {0, 8}, numbers(408));
  ASSERT_EQ(closed.bodies(), std::vector<int>{0});
  const Enclosed found = closed.enclosed(x);
  EXPECT_EQ(found.asked, 400);
  EXPECT_TRUE(found.undecided.empty());
  std::vector<Enclosed::Pair> expected;
  for (int v = 8; v < 408; ++v) {
    const bool in = (x.col(v).array() > 0).all() && (x.col(v).array() < 1).all();
    if (in) expected.emplace_back(0, v);
  }
  ASSERT_GT(expected.size(), 30u);
  EXPECT_EQ(found.inside, expected);
  const std::vector<double> depths = closed.depths(found.inside, x);
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const Vec3d p = x.col(found.inside[i].second);
    EXPECT_NEAR(depths[i], std::min(p.minCoeff(), (1 - p.array()).minCoeff()), 1e-14);
  }
}

TEST(Enclosed, rays_through_edges_and_corners_are_replaced) {
  // Every axis ray of the middle meets a diagonal; a point above a corner meets edges on its way down.
  const Positions x = with_points({{0.5, 0.5, 0.5}, {0.25, 0.25, 0.25}, {0, 0, 2}, {0.5, 0.5, -1}});
  const AuditMesh mesh = cube_and_points();
  const Enclosed found = ClosedBodies(mesh, {0, 8}, numbers(12)).enclosed(x);
  EXPECT_EQ(found.inside, (std::vector<Enclosed::Pair>{{0, 8}, {0, 9}}));
  EXPECT_TRUE(found.undecided.empty());
}

TEST(Enclosed, a_vertex_on_the_surface_is_undecided_and_keeps_its_side) {
  const AuditMesh mesh = cube_and_points();
  const ClosedBodies closed(mesh, {0, 8}, numbers(9));
  const Enclosed before = closed.enclosed(with_points({{0.4, 0.3, 2}}));
  Enclosed on = closed.enclosed(with_points({{0.4, 0.3, 1}}));
  EXPECT_EQ(on.undecided, (std::vector<Enclosed::Pair>{{0, 8}}));
  EXPECT_TRUE(changed_sides(before, on).empty());
  on.settle(before);
  EXPECT_TRUE(on.undecided.empty());
  const Enclosed in = closed.enclosed(with_points({{0.4, 0.3, 0.9}}));
  EXPECT_EQ(changed_sides(on, in), (std::vector<Enclosed::Pair>{{0, 8}}));
  Enclosed back = closed.enclosed(with_points({{0.4, 0.3, 1}}));
  back.settle(in);
  EXPECT_EQ(back.inside, in.inside);
}

TEST(Enclosed, an_open_body_encloses_nothing) {
  AuditMesh mesh = cube_and_points();
  mesh.triangles = Eigen::Matrix3Xi(mesh.triangles.leftCols(11));
  const ClosedBodies closed(mesh, {0, 8}, numbers(9));
  EXPECT_TRUE(closed.bodies().empty());
  EXPECT_TRUE(closed.enclosed(with_points({{0.5, 0.5, 0.5}})).inside.empty());
}

}  // namespace
}  // namespace bb::audit::enclosed_test
