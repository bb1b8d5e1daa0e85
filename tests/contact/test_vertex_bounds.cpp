// Bounds of each vertex: closed forms, and that no parts up to them let anything through.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <limits>
#include <random>

#include "core/math/types.hpp"
#include "tests/contact/bound_of.hpp"
#include "tests/contact/moving_obstacles.hpp"
#include "tests/contact/obstacle_scenes.hpp"

namespace bb::test::vertex_bounds_test {
namespace {

constexpr double gamma = 0.9;
constexpr StepBoundRule each_rule[] = {StepBoundRule::planar_truncation, StepBoundRule::planar_balanced,
                                       StepBoundRule::per_vertex};

struct Found {
  StepBound bound;
  std::vector<double> part;
};

Found parts_of(const Scene& scene, const Positions& x1, StepBoundRule rule) {
  ContactOptions options;
  options.step_bound = rule;
  ContactSystem contacts(scene, options);
  contacts.update_candidates_of_each(scene.x0, x1);
  Found out{contacts.vertex_bounds(scene.x0, x1), {}};
  out.part.assign(contacts.vertex_parts().begin(), contacts.vertex_parts().end());
  return out;
}

Positions moved_by_parts(const Scene& scene, const Positions& x1, const std::vector<double>& part) {
  Positions out = scene.x0;
  for (std::size_t v = 0; v < part.size(); ++v) {
    const int i = static_cast<int>(v);
    out.col(i) += part[v] * (x1.col(i) - scene.x0.col(i));
  }
  return out;
}

/// A triangle of side about 1 in the plane z = 0, and a point over its inside.
Scene point_over_triangle(double height, double offset = 0, double reach = d_hat) {
  Scene scene;
  add_body(scene, "triangle", {Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(0, 1, 0)}, {{0, 1, 2}}, d_hat, false,
           offset);
  add_body(scene, "point", {Vec3d(0.3, 0.3, height)}, {}, reach, false, offset);
  return scene;
}

TEST(VertexBounds, APlaneDividesTheGapAsBothSidesApproach) {
  const Scene scene = point_over_triangle(0.1);
  Positions x1 = scene.x0;
  x1.row(2) << 0.2, 0.1, 0.3, -0.5;  // the triangle rises by up to 0.3, the point falls by 0.6
  x1(0, 3) = 5;                      // and goes aside, which nothing holds
  const Found found = parts_of(scene, x1, StepBoundRule::planar_truncation);
  const double of_triangle = gamma * 0.1 * 0.3 / 0.9, of_point = gamma * 0.1 * 0.6 / 0.9;
  const double expected[] = {of_triangle / 0.2, of_triangle / 0.1, of_triangle / 0.3, of_point / 0.6};
  for (std::size_t v = 0; v < 4; ++v) EXPECT_NEAR(found.part[v], expected[v], 1e-13) << v;
  EXPECT_NEAR(found.bound.alpha, of_triangle / 0.3, 1e-13);
  EXPECT_EQ(found.bound.key[0], 2);
  EXPECT_EQ(found.bound.queries, 0);
}

/// A corner of a triangle 0.1 beyond a point, its other vertices 0.02 behind it; all of them move along x.
Scene point_at_corner() {
  Scene scene;
  add_body(scene, "triangle", {Vec3d(0, 0, 0), Vec3d(0.02, 0.5, 0), Vec3d(0.02, -0.5, 0)}, {{0, 1, 2}},
           d_hat);
  add_body(scene, "point", {Vec3d(-0.1, 0, 0)}, {}, d_hat);
  return scene;
}

TEST(VertexBounds, ABalancedPlaneIsPlacedByWhatComesOnFromBehind) {
  const Scene scene = point_at_corner();
  Positions x1 = scene.x0;
  x1.row(0) += Eigen::RowVector4d(0.2, -0.3, -0.1, 0.1);  // the corner goes back, all others come on
  const Found published = parts_of(scene, x1, StepBoundRule::planar_truncation);
  EXPECT_NEAR(published.part[1], gamma * 0.02 / 0.3, 1e-13);  // the plane is at the corner
  EXPECT_NEAR(published.part[3], gamma * 0.1 / 0.1, 1e-13);
  const Found balanced = parts_of(scene, x1, StepBoundRule::planar_balanced);
  const double part = (0.1 + 0.02) / (0.3 + 0.1);  // of their motion until the fastest two meet
  EXPECT_EQ(balanced.part[0], 1);
  EXPECT_NEAR(balanced.part[1], gamma * part, 1e-13);
  EXPECT_NEAR(balanced.part[2], gamma * part * 0.3 / 0.1, 1e-13);
  EXPECT_NEAR(balanced.part[3], gamma * part, 1e-13);
  EXPECT_GT(balanced.bound.alpha, 4 * published.bound.alpha);
}

/// The smallest part of the pair with the plane at `place` of its gap from the triangle on.
double least_part(const Scene& scene, const Positions& x1, double place) {
  double least = 1;
  for (int v = 0; v < 4; ++v) {
    const double moved = x1(0, v) - scene.x0(0, v), towards = v < 3 ? -moved : moved;
    const double room = v < 3 ? scene.x0(0, v) + 0.1 * place : 0.1 * (1 - place);
    if (towards > 0) least = std::min(least, gamma * room / towards);
  }
  return least;
}

TEST(VertexBounds, NoPlaceLeavesTheSlowestVertexMoreThanTheBalancedOne) {
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  const Scene scene = point_at_corner();
  int bound = 0, better = 0;
  for (int trial = 0; trial < 200; ++trial) {
    Positions x1 = scene.x0;
    for (int v = 0; v < 4; ++v) x1(0, v) += 0.5 * unit(rng);
    const double least = parts_of(scene, x1, StepBoundRule::planar_balanced).bound.alpha;
    double most = 0;
    for (int place = 0; place <= 1000; ++place) most = std::max(most, least_part(scene, x1, place / 1000.0));
    EXPECT_GE(least, most - 1e-12) << trial;
    EXPECT_LT(least, most + 0.05) << trial;
    bound += least < 1 ? 1 : 0;
    better += least > 1.01 * parts_of(scene, x1, StepBoundRule::planar_truncation).bound.alpha ? 1 : 0;
  }
  EXPECT_GT(bound, 100);
  EXPECT_GT(better, 20);
}

TEST(VertexBounds, ThicknessIsNoGap) {
  const Scene scene = point_over_triangle(0.1, 0.02);
  Positions x1 = scene.x0;
  x1(2, 3) = -0.5;
  EXPECT_NEAR(parts_of(scene, x1, StepBoundRule::planar_truncation).part[3], gamma * 0.06 / 0.6, 1e-13);
  EXPECT_NEAR(parts_of(scene, x1, StepBoundRule::per_vertex).part[3], gamma / 2 * 0.06 / 0.6, 1e-13);
}

TEST(VertexBounds, WhatGoesAwayOrAsideIsHeldByABallAlone) {
  const Scene scene = point_over_triangle(0.1, 0, 1);  // d_hat so long that the pair is a candidate
  for (const Vec3d& way : {Vec3d(0.6, 0, 0), Vec3d(0, 0, 0.6)}) {
    Positions x1 = scene.x0;
    x1.col(3) += way;
    EXPECT_EQ(parts_of(scene, x1, StepBoundRule::planar_truncation).bound.alpha, 1);
    const Found ball = parts_of(scene, x1, StepBoundRule::per_vertex);
    EXPECT_NEAR(ball.part[3], gamma / 2 * 0.1 / 0.6, 1e-13);
    EXPECT_EQ(ball.part[0], 1);  // a vertex that stands still goes all of its way
  }
}

TEST(VertexBounds, AnObstacleThatStandsStillHasNothingToShare) {
  Scene scene;
  add_body(scene, "triangle", {Vec3d(-1, -1, 1.1), Vec3d(1, -1, 1.1), Vec3d(0, 1, 1.1)}, {{0, 1, 2}}, d_hat);
  scene.obstacles = {round_obstacle(ObstacleKind::sphere, Vec3d::Zero(), 1)};
  Positions x1 = scene.x0;
  x1.row(2) << 0.5, 0.8, 1.3;  // down by 0.6 and 0.3, up by 0.2
  const Found planar = parts_of(scene, x1, StepBoundRule::planar_truncation);
  EXPECT_NEAR(planar.part[0], gamma * 0.1 / 0.6, 1e-13);
  EXPECT_NEAR(planar.part[1], gamma * 0.1 / 0.3, 1e-13);
  EXPECT_EQ(planar.part[2], 1);
  const Found ball = parts_of(scene, x1, StepBoundRule::per_vertex);
  EXPECT_NEAR(ball.part[0], gamma * 0.1 / 0.6, 1e-13);
  EXPECT_NEAR(ball.part[2], gamma * 0.1 / 0.2, 1e-13);

  const Scene moving = with_moving_obstacles(scene);
  Positions both(3, 4);
  both << x1, Vec3d(0, 0, 0.3);  // the ball rises by 0.3
  const Found divided = parts_of(moving, both, StepBoundRule::planar_truncation);
  EXPECT_NEAR(divided.part[3], gamma * 0.1 * (0.3 / 0.9) / 0.3, 1e-13);
  EXPECT_NEAR(divided.part[0], gamma * 0.1 * (0.6 / 0.9) / 0.6, 1e-13);
}

TEST(VertexBounds, OverAPlaneAndInsideABall) {
  Scene scene;
  add_body(scene, "point", {Vec3d(0.5, 0, 0.1)}, {}, d_hat);
  Obstacle floor;
  floor.kind = ObstacleKind::plane;
  floor.point = Vec3d::Zero();
  floor.axis = Vec3d::UnitZ();
  Obstacle shell = round_obstacle(ObstacleKind::sphere, Vec3d(0, 0, 0.1), 1);
  shell.inside = true;
  Positions x1 = scene.x0;
  x1.col(0) += Vec3d(3, 0, -0.4);
  scene.obstacles = {floor};
  EXPECT_NEAR(parts_of(scene, x1, StepBoundRule::planar_truncation).part[0], gamma * 0.1 / 0.4, 1e-13);
  scene.obstacles = {shell};
  const double way = std::sqrt(9 + 0.16);
  for (const StepBoundRule rule : each_rule)
    EXPECT_NEAR(parts_of(scene, x1, rule).part[0], gamma * 0.5 / way, 1e-13);
}

TEST(VertexBounds, WhatIsNotFiniteGoesNowhere) {
  const Scene scene = point_over_triangle(0.1);
  Positions x1 = scene.x0;
  x1(1, 2) = std::numeric_limits<double>::quiet_NaN();
  const Found found = parts_of(scene, x1, StepBoundRule::planar_truncation);
  for (const double part : found.part) EXPECT_EQ(part, 0);
}

/// Wavy sheets that run into each other, a ball, a bar and a floor, with random motions as long as the scene.
Scene sheets_between_obstacles(unsigned seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  Scene scene;
  for (int layer = 0; layer < 3; ++layer) {
    auto [vertices, triangles] = grid(6, 6, 0.15, Vec3d(-0.4, -0.45, 0.4 + 0.02 * layer));
    for (Vec3d& x : vertices)
      x += Vec3d(0.03, 0.03, 0.006).cwiseProduct(Vec3d(unit(rng), unit(rng), unit(rng)));
    add_body(scene, "sheet", vertices, triangles, d_hat);
  }
  Obstacle floor;
  floor.kind = ObstacleKind::plane;
  floor.point = Vec3d(0, 0, -0.3);
  floor.axis = Vec3d::UnitZ();
  scene.obstacles = {round_obstacle(ObstacleKind::sphere, Vec3d(0, 0, 0.08), 0.25),
                     round_obstacle(ObstacleKind::cylinder, Vec3d(0.4, 0, 0.15), 0.1, Vec3d::UnitY()), floor};
  return scene;
}

/// The vertices take any parts up to their bounds, together or one after the other: ACCD, which knows nothing of planes,
/// finds none of these straight motions to touch anything. Without the bounds it stops them early.
TEST(VertexBounds, NothingPassesWhateverPartsAreTaken) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    const Scene still = sheets_between_obstacles(seed);
    const Scene scene = seed % 2 == 0 ? still : with_moving_obstacles(still);
    std::mt19937_64 rng(seed + 100);
    std::uniform_real_distribution<double> unit(-1, 1), part(0, 1);
    const double length = seed < 6 ? 0.5 : 0.03;
    Positions x1 = scene.x0;
    for (Eigen::Index i = 0; i < x1.size(); ++i) x1.data()[i] += length * unit(rng);
    ContactSystem contacts(scene, {});
    const auto proven = [&](const Positions& from, const Positions& to) {
      contacts.update_candidates(from, to);
      return contacts.step_bound(from, to).alpha;
    };
    ASSERT_LT(proven(scene.x0, x1), 0.5);
    for (const StepBoundRule rule : each_rule) {
      const Found found = parts_of(scene, x1, rule);
      ASSERT_GT(found.bound.alpha, 0);
      const Positions whole = moved_by_parts(scene, x1, found.part);
      EXPECT_EQ(proven(scene.x0, whole), 1) << seed;
      std::vector<double> some = found.part;
      for (double& each : some) each *= part(rng);
      const Positions between = moved_by_parts(scene, x1, some);
      EXPECT_EQ(proven(scene.x0, between), 1) << seed;
      EXPECT_EQ(proven(between, whole), 1) << seed;
    }
  }
}

/// What is a candidate when all vertices share one time is not enough: of two points that fall together one may stop.
TEST(VertexBounds, CandidatesAreThoseOfEveryPace) {
  Scene scene = point_over_triangle(1);
  Positions x1 = scene.x0;
  x1.row(2).array() -= 3;  // all fall together, one behind the other
  ContactSystem contacts(scene, {});
  contacts.update_candidates(scene.x0, x1);
  EXPECT_EQ(contacts.candidate_counts().point_triangle, 0U);
  contacts.update_candidates_of_each(scene.x0, x1);
  EXPECT_EQ(contacts.candidate_counts().point_triangle, 1U);
  const Found found = parts_of(scene, x1, StepBoundRule::planar_truncation);
  EXPECT_NEAR(found.part[3], gamma * 1 / 3, 1e-13);  // up to where the triangle may stay
  EXPECT_EQ(found.part[0], 1);
}

TEST(VertexBounds, PartsDoNotDependOnThreads) {
  const Scene scene = sheets_between_obstacles(3);
  Positions x1 = scene.x0;
  x1.row(2).array() -= 0.4;
  x1.row(2) += 0.1 * scene.x0.row(0);
  for (const StepBoundRule rule : each_rule) {
    const Found many = parts_of(scene, x1, rule);
    const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
    const Found alone = parts_of(scene, x1, rule);
    EXPECT_LT(alone.bound.alpha, 1);
    EXPECT_EQ(alone.part, many.part);
  }
}

// --- areas

/// Every triangle has a third at each corner and at each side; all pairs of two flat sheets together have half of each.
TEST(PairAreas, AreThoseOfTheSurface) {
  Scene scene;
  const auto [vertices, triangles] = grid(4, 3, 0.5);
  add_body(scene, "sheet", vertices, triangles, d_hat);
  Obstacle floor;
  floor.kind = ObstacleKind::plane;
  floor.axis = Vec3d::UnitZ();
  scene.obstacles = {floor, round_obstacle(ObstacleKind::sphere, Vec3d(0, 0, -2), 1),
                     round_obstacle(ObstacleKind::cylinder, Vec3d(0, 0, -2), 1, Vec3d::UnitX())};
  ContactOptions options;
  options.weighting = ContactWeighting::area;
  const ContactSystem contacts(scene, options);
  const PairAreas& areas = *contacts.areas();
  EXPECT_EQ(areas.without_area(), -1);
  constexpr double area = 4 * 3 * 0.25;
  double points = 0, edges = 0, triangles_sum = 0, between = 0;
  const auto each = [](int n, const auto& add) {
    for (int i = 0; i < n; ++i) add(static_cast<PairId>(i));
  };
  each(20, [&](PairId i) { points += areas.of(pair_id(obstacle_pairs, i, 0)); });
  each(20, [&](PairId i) { between += areas.of(pair_id(obstacle_pairs, i, 2)); });
  each(4 * 4 + 3 * 5 + 12, [&](PairId i) { edges += areas.of(pair_id(obstacle_pairs + 1, i, 2)); });
  each(24, [&](PairId i) { triangles_sum += areas.of(pair_id(obstacle_pairs + 2, i, 1)); });
  EXPECT_NEAR(points, area, 1e-12);
  EXPECT_NEAR(between, area / 2, 1e-12);
  EXPECT_NEAR(edges, area / 2, 1e-12);
  EXPECT_NEAR(triangles_sum, area, 1e-12);
  const int inner = 1 * 5 + 1;  // six triangles
  EXPECT_NEAR(areas.of(pair_id(static_cast<int>(PairKind::point_triangle), inner, 20)), 6 * 0.125 / 3 / 4,
              1e-14);
  EXPECT_GT(areas.of(pair_id(static_cast<int>(PairKind::edge_edge), 0, 9)), 0);
}

TEST(PairAreas, AreMissedWhereThereIsNoTriangle) {
  Scene scene = point_over_triangle(0.1);
  ContactOptions options;
  options.weighting = ContactWeighting::area;
  EXPECT_EQ(ContactSystem(scene, options).areas()->without_area(), 3);
  EXPECT_EQ(ContactSystem(scene, {}).areas(), nullptr);
}

}  // namespace
}  // namespace bb::test::vertex_bounds_test
