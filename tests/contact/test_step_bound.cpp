// The largest collision-free step: never late on motions with a known time, tight, cheap for sliding pairs.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <limits>

#include "core/contact/pair_name.hpp"
#include "core/contact/pair_planes.hpp"
#include "tests/contact/bound_of.hpp"

namespace bb::test::step_bound_test {
namespace {

Scene point_above_floor(double height) {
  Scene scene;
  const auto [vertices, triangles] = grid(2, 2, 1.0);
  add_body(scene, "floor", vertices, triangles, d_hat, true);
  add_body(scene, "point", {Vec3d(0.7, 0.4, height)}, {}, d_hat);
  return scene;
}

TEST(StepBound, FallingPointStopsAtTheExactTime) {
  const Scene scene = point_above_floor(1);
  Positions x1 = scene.x0;
  x1(2, 9) = -1;
  const StepBound b = bound(scene, x1);
  const double park = 1e-6 * d_hat;
  EXPECT_LE(b.alpha, (1 - park) / 2);
  EXPECT_NEAR(b.alpha, (1 - park) / 2, 1e-12);
  EXPECT_EQ(b.kind, ContactKind::point_triangle);
  EXPECT_EQ(b.key[3], 9);
  EXPECT_GE(b.queries, 1);
  EXPECT_LE(b.probes, 4 * b.queries);
  EXPECT_EQ(b.zero, 0);
  EXPECT_EQ(b.capped, 0);
}

TEST(StepBound, AMotionThatIsNotFiniteIsNotTakenAtAll) {
  const Scene scene = point_above_floor(1);
  Positions x1 = scene.x0;
  x1(2, 9) = 0.5;
  ASSERT_EQ(bound(scene, x1).alpha, 1);
  ContactSystem contacts(scene, {});
  contacts.update_candidates(scene.x0, x1);  // as for a motion that becomes NaN behind it
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(),
                   inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, -inf}) {
    for (Eigen::Index i = 0; i < x1.size(); ++i) {
      Positions start = scene.x0, end = x1;
      start.data()[i] = end.data()[i] = bad;
      EXPECT_EQ(contacts.step_bound(scene.x0, end).alpha, 0) << i;
      EXPECT_EQ(contacts.step_bound(start, x1).alpha, 0) << i;
    }
  }
}

/// Planes and axes of a pair, with each number of its motion in turn NaN.
TEST(StepBound, WhatIsNoNumberIsProvenByNoPlane) {
  constexpr PairKind K = PairKind::edge_edge;
  const PairLanes<K, double> points{{{0, 0, 0}, {1, 0, 0}, {0.5, -0.5, 1}, {0.5, 0.5, 1}}};
  PairLanes<K, double> motion{{{0, 0, 0}, {0, 0, 0.1}, {0, 0, 0}, {0, 0, 0}}};
  ASSERT_GT((proven_times<K, double>(points, motion, 0.1, 1.0)), 1);
  ASSERT_GT((proven_times_by_axes<K, double>(points, motion, 0.1)), 1);
  for (auto& vertex : motion.x) {
    const double kept = vertex[2];
    vertex[2] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ((proven_times<K, double>(points, motion, 0.1, 1.0)), 0);
    vertex[2] = kept;
  }
}

TEST(StepBound, CrossingEdgesStopAtTheExactTime) {
  Scene scene;
  add_body(scene, "a", {Vec3d(-1, 0, 0), Vec3d(1, 0, 0)}, {}, d_hat);
  add_body(scene, "b", {Vec3d(0, -1, 1), Vec3d(0, 1, 1)}, {}, d_hat);
  scene.surface_edges = {{0, 1}, {2, 3}};
  Positions x1 = scene.x0;
  x1.row(2) << 2, 2, -2, -2;
  const StepBound b = bound(scene, x1);
  EXPECT_LE(b.alpha, 0.2);
  EXPECT_NEAR(b.alpha, 0.2, 1e-8);
  EXPECT_EQ(b.kind, ContactKind::edge_edge);
  EXPECT_EQ(b.key, (ContactKey{0, 1, 2, 3}));
}

TEST(StepBound, OffsetsKeepTheSurfacesApart) {
  Scene scene = point_above_floor(1);
  scene.offset.assign(scene.offset.size(), 0.05);
  Positions x1 = scene.x0;
  x1(2, 9) = -1;
  EXPECT_NEAR(bound(scene, x1).alpha, 0.45, 1e-8);
  EXPECT_LE(bound(scene, x1).alpha, 0.45);
}

TEST(StepBound, SlidingAndSeparatingPairsAreFreeAndCheap) {
  Scene scene;
  const auto [v1, t1] = grid(12, 12, 0.1);
  const auto [v2, t2] = grid(12, 12, 0.1, Vec3d(0.03, 0.02, 1e-4));
  add_body(scene, "floor", v1, t1, d_hat, true);
  const int cloth = add_body(scene, "cloth", v2, t2, d_hat);
  Positions x1 = scene.x0;
  x1.rightCols(169).colwise() += Vec3d(0.25, 0.1, 0);
  const StepBound slide = bound(scene, x1);
  EXPECT_EQ(slide.alpha, 1);
  EXPECT_GT(n_pairs(scene, x1), 10000U);
  EXPECT_LT(50 * static_cast<std::size_t>(slide.queries), n_pairs(scene, x1));
  EXPECT_LE(slide.probes, 2 * slide.queries);

  x1 = scene.x0;
  x1.rightCols(169).colwise() += Vec3d(0.25, 0.1, 0.3);
  const StepBound separate = bound(scene, x1);
  EXPECT_EQ(separate.alpha, 1);
  EXPECT_LE(separate.probes, 2 * separate.queries);
  EXPECT_EQ(cloth, 169);
}

/// Two sheets within d_hat of each other, each moved as a whole.
struct TwoSheets {
  Scene scene;
  Positions x1;
  TwoSheets(const Vec3d& low, const Vec3d& high) {
    const auto [v1, t1] = grid(6, 6, 0.1);
    const auto [v2, t2] = grid(6, 6, 0.1, Vec3d(0.03, 0.02, d_hat / 2));
    add_body(scene, "low", v1, t1, d_hat);
    const int first = add_body(scene, "high", v2, t2, d_hat);
    x1 = scene.x0;
    x1.leftCols(first).colwise() += low;
    x1.rightCols(x1.cols() - first).colwise() += high;
  }
  std::size_t n_rows() const {  // none within a sheet: its points are 10 d_hat apart
    ContactSystem contacts(scene, {});
    return rows_at(contacts, scene.x0).table.size();
  }
};

TEST(StepBound, RigidMotionOfEverythingIsFreeAndHardlyAsksForAQuery) {
  const TwoSheets sheets({0.4, 0.3, 0.7}, {0.4, 0.3, 0.7});
  const StepBound b = bound(sheets.scene, sheets.x1);
  EXPECT_EQ(b.alpha, 1);
  EXPECT_GT(sheets.n_rows(), 50U);
  EXPECT_GT(n_pairs(sheets.scene, sheets.x1), 1000U);
  EXPECT_LT(100 * static_cast<std::size_t>(b.queries), n_pairs(sheets.scene, sheets.x1));
  EXPECT_EQ(b.probes, b.queries);
}

TEST(StepBound, BodiesThatPartHardlyAskForAQuery) {
  const TwoSheets sheets({-0.4, -0.3, -0.7}, {0.4, 0.3, 0.7});
  const StepBound b = bound(sheets.scene, sheets.x1);
  EXPECT_EQ(b.alpha, 1);
  EXPECT_GT(sheets.n_rows(), 50U);
  EXPECT_GT(n_pairs(sheets.scene, sheets.x1), 1000U);
  EXPECT_LT(100 * static_cast<std::size_t>(b.queries), n_pairs(sheets.scene, sheets.x1));
}

TEST(StepBound, PairsThatHaveNoRowStillBound) {
  // one body, closer at rest than d_hat: its row is shortened, its collision is not ignored
  Scene scene;
  add_body(scene, "body", {Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0.2, 0.2, 0.006)},
           {{0, 1, 2}}, d_hat);
  Positions x1 = scene.x0;
  x1(2, 3) = -0.006;
  const StepBound b = bound(scene, x1);
  EXPECT_LT(b.alpha, 0.5);
  EXPECT_NEAR(b.alpha, 0.5, 1e-5);
}

TEST(StepBound, ObstaclesBoundFreeVertices) {
  Scene scene;
  add_body(scene, "point", {Vec3d(0, 0, 1), Vec3d(5, 0, 1)}, {}, d_hat);
  scene.obstacles.push_back({});  // the plane z = 0
  Obstacle sphere;
  sphere.name = "ball";
  sphere.kind = ObstacleKind::sphere;
  sphere.point = Vec3d(5, 0, -1);
  sphere.radius = 1.5;
  scene.obstacles.push_back(sphere);
  Positions x1 = scene.x0;
  x1.row(2).array() -= 1;
  ContactSystem contacts(scene, {});
  contacts.update_candidates(scene.x0, x1);
  const StepBound b = contacts.step_bound(scene.x0, x1);
  EXPECT_LE(b.alpha, 0.5);
  EXPECT_NEAR(b.alpha, 0.5, 1e-7);
  EXPECT_EQ(b.kind, ContactKind::obstacle);
  EXPECT_EQ(b.key, (ContactKey{-1, -1, -3, 1}));
  EXPECT_EQ(pair_name(scene, b.key, b.kind), "obstacle: ball, point[1]");
}

TEST(StepBound, NamesTheFirstOfTheContactsThatLimitAlikeAndNoneOfAFreeMotion) {
  Scene scene;
  add_body(scene, "points", {Vec3d(0, 0, 1), Vec3d(1, 0, 1), Vec3d(2, 0, 1)}, {}, 0.1);
  scene.obstacles.push_back({});  // the plane z = 0
  ContactSystem contacts(scene, {});
  const auto bound = [&](double fall) {
    Positions x1 = scene.x0;
    x1.row(2).array() -= fall;
    contacts.update_candidates(scene.x0, x1);
    return contacts.step_bound(scene.x0, x1);
  };
  const StepBound stopped = bound(2);
  EXPECT_NEAR(stopped.alpha, 0.5, 1e-6);
  EXPECT_EQ(stopped.key, (ContactKey{-1, -1, -2, 0}));
  const StepBound free = bound(0.95);
  EXPECT_EQ(free.alpha, 1);
  EXPECT_EQ(free.key, (ContactKey{-1, -1, -1, -1}));
}

TEST(StepBound, ZeroIsCountedWhenThePairTouchesAtTheStart) {
  const Scene scene = point_above_floor(0);
  Positions x1 = scene.x0;
  x1(2, 9) = -1;
  const StepBound b = bound(scene, x1);
  EXPECT_EQ(b.alpha, 0);
  EXPECT_GE(b.zero, 1);
}

TEST(StepBound, RoundedStatesStayFeasibleOnRandomMotions) {
  int bounded = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    Scene scene;
    const auto [v1, t1] = soup(40, 0.2, seed);
    const auto [v2, t2] = soup(40, 0.2, seed + 100);
    add_body(scene, "a", v1, t1, 0.01);
    add_body(scene, "b", v2, t2, 0.01);
    ContactSystem contacts(scene, {});
    const Positions x1 = random_motion(scene.x0, 0.3, seed);
    contacts.update_candidates(scene.x0, x1);
    const StepBound b = contacts.step_bound(scene.x0, x1);
    EXPECT_GT(b.alpha, 0);
    bounded += b.alpha < 1;
    ContactTable rows;
    MollifiedTable mollified;
    for (double fraction : {0.25, 0.5, 0.999, 1.0}) {
      const Positions x = scene.x0 + fraction * b.alpha * (x1 - scene.x0);
      EXPECT_GT(contacts.find_rows(x, rows, mollified), 0);
    }
  }
  EXPECT_GE(bounded, 5);
}

TEST(StepBound, SameForAnyNumberOfThreads) {
  Scene scene;
  const auto [v1, t1] = soup(200, 0.2, 1);
  add_body(scene, "a", v1, t1, 0.01);
  scene.obstacles.push_back({});
  scene.obstacles[0].point = Vec3d(0, 0, -5);
  const Positions x1 = random_motion(scene.x0, 0.2, 4);
  StepBound reference;
  for (std::size_t threads : {1, 2, 5}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    const StepBound b = bound(scene, x1);
    if (threads == 1) reference = b;
    EXPECT_EQ(b.alpha, reference.alpha);
    EXPECT_EQ(b.key, reference.key);
    EXPECT_EQ(b.queries, reference.queries);
    EXPECT_EQ(b.probes, reference.probes);
  }
  EXPECT_LT(reference.alpha, 1);
  EXPECT_GT(reference.queries, 10);
}

TEST(StepBound, PlanarPairsAreBoundedToo) {
  for (PlanarPairs pairs : {PlanarPairs::vertex_vertex, PlanarPairs::point_edge}) {
    Scene scene;
    scene.planar = true;
    scene.planar_pairs = pairs;
    add_body(scene, "wall", {Vec3d(0, 0, 0), Vec3d(1, 0, 0)}, {}, d_hat, true);
    scene.surface_edges = {{0, 1}};
    const bool edge = pairs == PlanarPairs::point_edge;
    add_body(scene, "point", {Vec3d(edge ? 0.5 : 0.0, 1, 0)}, {}, d_hat);
    Positions x1 = scene.x0;
    x1(1, 2) = -1;
    const StepBound b = bound(scene, x1);
    EXPECT_LT(b.alpha, 0.5);
    EXPECT_NEAR(b.alpha, 0.5, 1e-7);
    EXPECT_EQ(b.kind, edge ? ContactKind::point_edge : ContactKind::point_point);
  }
}

}  // namespace
}  // namespace bb::test::step_bound_test
