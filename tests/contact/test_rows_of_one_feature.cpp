// Rows of pairs with the same closest feature: one each, so that B is continuous where that changes.
#include <gtest/gtest.h>

#include <set>

#include "tests/contact/contact_scenes.hpp"
#include "tests/contact/one_feature.hpp"

namespace bb::test::rows_of_one_feature_test {
namespace {

constexpr double d_hat = 0.1;

TEST(Rows, EveryPairOfOneFeatureHasItsOwn) {
  // above vertex 12 (2, 2): six triangles have it as their closest point
  const Scene over_vertex = point_over_grid(Vec3d(2, 2, 0.05), d_hat);
  ContactSystem contacts(over_vertex, {});
  const Rows at_vertex = rows_at(contacts, over_vertex.x0);
  expect_one_feature(at_vertex, ContactKind::point_point, 6, 0.05);
  EXPECT_EQ(at_vertex.table.key(0), (ContactKey{-1, -1, 12, 25}));

  // above the straight edge 11-12, nearer to one side: that triangle's interior, and the edge for the other
  const Scene beside = point_over_grid(Vec3d(1.5, 2.001, 0.05), d_hat);
  ContactSystem contacts2(beside, {});
  const Rows rows = rows_at(contacts2, beside.x0);
  EXPECT_EQ(rows.table.size(), 2U);
  EXPECT_GE(find_row(rows.table, {-1, 11, 12, 25}, ContactKind::point_edge), 0);
}

TEST(Rows, BarrierIsContinuousWhereTheClosestFeatureChanges) {
  const Scene scene = point_over_grid(Vec3d::Zero(), d_hat);
  ContactSystem contacts(scene, {});
  // across a straight edge, a diagonal, over a vertex, past the border, and off a corner of the sheet
  const Vec3d from[] = {
      {1.5, 1.99, 0.05}, {1.48, 1.52, 0.05}, {1.99, 1.985, 0.05}, {1.3, 0.01, 0.05}, {0.01, 0.01, 0.05}};
  const Vec3d to[] = {
      {1.5, 2.01, 0.05}, {1.52, 1.48, 0.05}, {2.01, 2.015, 0.05}, {1.3, -0.01, 0.05}, {-0.01, -0.01, 0.05}};
  int changes = 0;
  for (std::size_t path = 0; path < 5; ++path) {
    const auto state = [&](double t) {
      Positions x = scene.rest;
      x.col(25) = from[path] + t * (to[path] - from[path]);
      return x;
    };
    // bisect for every place where the keys change, then compare B on both sides of it
    const auto keys = [&](double t) { return keys_of(rows_at(contacts, state(t)).table); };
    double left = 0;
    for (int k = 1; k <= 20; ++k) {
      double lo = left, hi = k / 20.0;
      left = hi;
      if (keys(lo) == keys(hi)) continue;
      const auto at_lo = keys(lo);
      for (int b = 0; b < 60; ++b) {
        const double middle = (lo + hi) / 2;
        (keys(middle) == at_lo ? lo : hi) = middle;
      }
      const double below = barrier(contacts, state(lo), 1), above = barrier(contacts, state(hi), 1);
      EXPECT_GT(below, 1e-4);
      EXPECT_NEAR(above, below, 1e-12 * below);
      ++changes;
    }
  }
  EXPECT_GE(changes, 5);
}

TEST(Rows, EdgesCrossingAGridKeepBContinuous) {
  Scene scene;
  const auto [vertices, triangles] = grid(3, 3, 1.0);
  add_body(scene, "sheet", vertices, triangles, d_hat);
  const int blade =
      add_body(scene, "blade", {Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(0, 0, 1)}, {{0, 1, 2}}, d_hat);
  ContactSystem contacts(scene, {Mollifier::none});
  const auto state = [&](double t) {
    Positions x = scene.rest;
    x.col(blade) = Vec3d(0.7 + 0.6 * t, 1.2 + 0.3 * t, 0.05);
    x.col(blade + 1) = Vec3d(1.6 + 0.6 * t, 1.5 + 0.3 * t, 0.07);
    x.col(blade + 2) = Vec3d(1.0, 1.2, 1.0);
    return x;
  };
  // B is Lipschitz with a constant that all forces bound: no jump between neighbouring samples
  double largest_step = 0, last = barrier(contacts, state(0), 1);
  const int n = 400;
  for (int k = 1; k <= n; ++k) {
    const double next = barrier(contacts, state(1.0 * k / n), 1);
    EXPECT_GT(next, 1e-4);
    largest_step = std::max(largest_step, std::abs(next - last));
    last = next;
  }
  // up to about 20 pairs, each with |b'| <= 2 d_hat, moved by 0.7/n
  EXPECT_LT(largest_step, 20 * 2 * d_hat * 0.7 / n);
}

TEST(Rows, OfOneFeatureHaveTheActivationDistancesOfTheirPairs) {
  // six triangles share the closest vertex; their mean activation distances differ
  Scene scene = point_over_grid(Vec3d(2, 2, 0.05), d_hat);
  scene.d_hat[12] = 0.2;
  scene.d_hat[6] = 0.17;  // corner of two of the six triangles round vertex 12
  ContactSystem contacts(scene, {});
  const Rows rows = rows_at(contacts, scene.x0);
  expect_one_feature(rows, ContactKind::point_point, 6, 0.05);
  const std::set<double> distances(rows.table.d_hat.begin(), rows.table.d_hat.end());
  EXPECT_GE(distances.size(), 2U);
}

TEST(Rows, PlanarPointEdgeHasTwoAtACorner) {
  Scene scene;
  scene.planar = true;
  scene.planar_pairs = PlanarPairs::point_edge;
  add_body(scene, "corner", {Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(0, 1, 0)}, {}, d_hat);
  scene.surface_edges = {{0, 1}, {0, 2}};
  add_body(scene, "point", {Vec3d(-0.03, -0.04, 0)}, {}, d_hat);
  ContactSystem contacts(scene, {});
  expect_one_feature(rows_at(contacts, scene.x0), ContactKind::point_point, 2, 0.05);
}

}  // namespace
}  // namespace bb::test::rows_of_one_feature_test
