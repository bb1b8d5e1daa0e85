// The contact model offset_geometric: one row a point and a feature, along the normal, nothing from what is shadowed.
#include <gtest/gtest.h>

#include <cmath>

#include "core/contact/contact_terms.hpp"
#include "tests/contact/barrier_gradient.hpp"

namespace bb::test::offset_blocks_test {
namespace {

ContactOptions offset_geometric(RestRule rule = RestRule::on) {
  ContactOptions options;
  options.model = ContactModel::offset_geometric;
  options.rest_rule = rule;
  return options;
}

/// Wherever a point is over a flat mesh, on lines and corners of it too: one row, its height, the normal of the mesh.
TEST(OffsetBlocks, APointOverAFlatMeshHasOneRow) {
  constexpr double d_hat = 2.5, height = 0.3;
  for (const auto& [x, y] :
       {std::pair(1.3, 2.2), std::pair(2.0, 2.0), std::pair(1.5, 1.5), std::pair(2.5, 2.0),
        std::pair(2.0, 1.25), std::pair(0.1, 3.9), std::pair(2.0 + 1e-13, 2.0), std::pair(1.5, 1.5 - 1e-14),
        std::pair(2.0 + 1e-11, 2.0 + 1e-11)}) {
    const Scene scene = point_over_grid(Vec3d(x, y, height), d_hat);
    ContactSystem blocks(scene, offset_geometric()), all(scene, ContactOptions{});
    const Rows rows = rows_at(blocks, scene.x0);
    ASSERT_EQ(rows.table.size(), 1u) << x << " " << y;
    EXPECT_NEAR(rows.table.d[0], height, 1e-14);
    EXPECT_NEAR(std::abs(rows.table.normal[2]), 1, 1e-9);
    EXPECT_EQ(rows.min_gap, rows.table.d[0]);
    EXPECT_GT(rows_at(all, scene.x0).table.size(), 10u);
  }
}

/// Beside its border a flat mesh pushes from its border edge, beyond a corner from the corner, and each once.
TEST(OffsetBlocks, BordersPushFromTheirClosestPoint) {
  constexpr double d_hat = 0.5;
  struct Case {
    Vec3d at, closest;
    ContactKind kind;
  };
  for (const Case& c : {Case{Vec3d(2.3, -0.2, 0.1), Vec3d(2.3, 0, 0), ContactKind::point_edge},
                        Case{Vec3d(2.0, -0.2, 0.1), Vec3d(2, 0, 0), ContactKind::point_point},
                        Case{Vec3d(-0.2, -0.1, 0.1), Vec3d(0, 0, 0), ContactKind::point_point},
                        Case{Vec3d(4.1, 2.7, 0), Vec3d(4, 2.7, 0), ContactKind::point_edge}}) {
    const Scene scene = point_over_grid(c.at, d_hat);
    ContactSystem blocks(scene, offset_geometric());
    const Rows rows = rows_at(blocks, scene.x0);
    ASSERT_EQ(rows.table.size(), 1u) << c.at.transpose();
    EXPECT_EQ(rows.table.kind[0], c.kind);
    EXPECT_NEAR(rows.table.d[0], (c.at - c.closest).norm(), 1e-14);
  }
}

/// A roof of two slopes: over the ridge one row at the ridge, in the valley one of each slope, and from the valley's line none.
TEST(OffsetBlocks, RidgesCountOnceAndValleysPushFromBothSides) {
  for (const double side : {1.0, -1.0}) {
    Scene scene;
    add_body(scene, "roof",
             {Vec3d(-1, 0, 0), Vec3d(1, 0, 0), Vec3d(0, 1.5, -0.5 * side), Vec3d(0, -1.5, -0.5 * side)},
             {{0, 1, 2}, {1, 0, 3}}, 1.0);
    add_body(scene, "point", {Vec3d(0.1, 0.02, 0.3)}, {}, 1.0);
    ContactSystem blocks(scene, offset_geometric());
    const Rows rows = rows_at(blocks, scene.x0);
    ASSERT_EQ(rows.table.size(), side > 0 ? 1u : 2u);
    for (const ContactKind kind : rows.table.kind)
      EXPECT_EQ(kind, side > 0 ? ContactKind::point_edge : ContactKind::point_triangle);
  }
}

/// Crossing edges of two flat sheets push along the normal alone, and nothing else of them does.
TEST(OffsetBlocks, FlatSheetsPushAlongTheirNormal) {
  constexpr double d_hat = 1.1;
  Scene scene;
  const auto [low, triangles] = grid(6, 6, 0.5);
  add_body(scene, "low", low, triangles, d_hat);
  auto [high, upper] = grid(3, 3, 0.4);
  const double c = std::cos(0.4), s = std::sin(0.4);
  for (Vec3d& v : high) v = Vec3d(c * v[0] - s * v[1] + 1.03, s * v[0] + c * v[1] + 0.57, 0.2);
  add_body(scene, "high", high, upper, d_hat);
  ContactSystem blocks(scene, offset_geometric(RestRule::off)), all(scene, ContactOptions{});
  const Rows rows = rows_at(blocks, scene.x0);
  ASSERT_GT(rows.table.size(), 30u);
  std::size_t edges = 0, points = 0, borders = 0;
  for (std::size_t r = 0; r < rows.table.size(); ++r) {
    if (rows.table.kind[r] == ContactKind::point_edge || rows.table.kind[r] == ContactKind::point_point) {
      ++borders;  // of the upper sheet, and what of the lower one is beside it
      EXPECT_GT(rows.table.d[r], 0.2 + 1e-9);
      continue;
    }
    EXPECT_NEAR(std::abs(rows.table.normal[3 * r + 2]), 1, 1e-9);
    EXPECT_NEAR(rows.table.d[r], 0.2, 1e-12);
    edges += rows.table.kind[r] == ContactKind::edge_edge ? 1 : 0;
    points += rows.table.kind[r] == ContactKind::point_triangle ? 1 : 0;
  }
  EXPECT_GT(edges, 10u);
  EXPECT_GE(points, 16u);
  EXPECT_GT(borders, 4u);
  EXPECT_GT(rows_at(all, scene.x0).table.size(), 5 * rows.table.size());
}

/// A sheet at rest, flat or rolled to a half pipe, within reach of itself: nothing of it is in a block of another part.
TEST(OffsetBlocks, ASheetAtRestDoesNotTouchItself) {
  for (const double bend : {0.0, 1.0}) {
    Scene scene;
    auto [vertices, triangles] = grid(12, 4, 0.25);
    if (bend > 0) {
      for (Vec3d& v : vertices) v = Vec3d(std::cos(v[0]), std::sin(v[0]), v[1]);
    }
    add_body(scene, "sheet", vertices, triangles, 0.55);
    ContactSystem blocks(scene, offset_geometric(RestRule::off));
    ContactOptions without_rule;
    without_rule.rest_rule = RestRule::off;
    ContactSystem all(scene, without_rule), ruled(scene, ContactOptions{});
    const Rows rows = rows_at(blocks, scene.x0);
    EXPECT_EQ(rows.table.size() + rows.mollified.size(), 0u) << bend;
    EXPECT_GT(rows_at(all, scene.x0).table.size(), 100u);
    EXPECT_EQ(rows_at(ruled, scene.x0).table.size(), 0u) << "the rest rule holds them off too";
  }
}

/// Within the blocks of a state gradient and energy agree.
TEST(OffsetBlocks, GradientIsThatOfTheEnergyWithinABlock) {
  Scene scene;
  const auto [low, triangles] = grid(3, 3, 0.7);
  add_body(scene, "low", low, triangles, 0.5);
  const auto [high, upper] = grid(3, 3, 0.6, Vec3d(0.05, 0.1, 0.25));
  add_body(scene, "high", high, upper, 0.5);
  ContactSystem blocks(scene, offset_geometric());
  const Positions x = random_motion(scene.x0, 0.08, 11);
  const VecXd gradient = gradient_of(blocks, x);
  ASSERT_GT(gradient.cwiseAbs().maxCoeff(), 0.1);
  const std::vector<PairId> pairs = rows_at(blocks, x).table.pair;
  ASSERT_GT(pairs.size(), 20u);
  double worst = 0;
  int compared = 0;
  constexpr double h = 1e-6;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    Positions a = x, b = x;
    a.data()[i] += h, b.data()[i] -= h;
    if (rows_at(blocks, a).table.pair != pairs || rows_at(blocks, b).table.pair != pairs) continue;
    const double slope =
        (barrier(blocks, a, 3.5, TestShape::cubic) - barrier(blocks, b, 3.5, TestShape::cubic)) / (2 * h);
    worst = std::max(worst, std::abs(slope - gradient[i]));
    ++compared;
  }
  EXPECT_GT(compared, 80);
  EXPECT_LT(worst, 1e-7 * gradient.cwiseAbs().maxCoeff());
}

}  // namespace
}  // namespace bb::test::offset_blocks_test
