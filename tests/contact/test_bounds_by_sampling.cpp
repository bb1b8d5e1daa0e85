// What the bounds of each vertex promise, on sampled motions: after each vertex has gone any part of its motion up to its bound,
// 1 - gamma of the gap is left of every gap that there was, thickness taken off. The gap that is left is measured in long double by
// enumeration of features, or by the formula of the obstacle: nothing of the code under test.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/contact/moving_obstacles.hpp"
#include "tests/contact/obstacle_scenes.hpp"
#include "tests/contact/sampled_pairs.hpp"

namespace bb::test::bounds_by_sampling_test {
namespace {

constexpr StepBoundRule each_rule[] = {StepBoundRule::planar_truncation, StepBoundRule::planar_balanced,
                                       StepBoundRule::per_vertex};

/// All of their parts, or any that are less: each vertex has its own.
Positions taken(Random& random, const Scene& scene, const Positions& x1, const std::vector<double>& part,
                bool all) {
  Positions out = scene.x0;
  for (std::size_t v = 0; v < part.size(); ++v) {
    const int i = static_cast<int>(v);
    const double share = all ? 1 : (random.rng() % 3 == 0 ? 1 : random.between(0, 1));
    out.col(i) += share * part[v] * (x1.col(i) - scene.x0.col(i));
  }
  return out;
}

bool bounded(const std::vector<double>& part) {
  return std::any_of(part.begin(), part.end(), [](double p) { return p < 1; });
}

TEST(BoundsBySampling, LeaveOfTheGapOfAPairWhatTheyPromise) {
  Random random(7);
  int bound[3] = {0, 0, 0}, closest = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const double gap = random.between(0.1, 0.9) * d_hat, offset = trial % 3 == 0 ? 0.4 * d_hat : 0;
    const PairScene pair = pair_scene(random, gap, offset);
    const double before = pair.distance(pair.scene.x0) - 2 * offset;
    ASSERT_GT(before, 0);
    const Positions x1 = head_on(random, pair, before);
    for (int r = 0; r < 3; ++r) {
      const std::vector<double> part = parts_of(pair.scene, x1, each_rule[r]);
      for (const bool all : {true, false}) {
        const double left = pair.distance(taken(random, pair.scene, x1, part, all)) - 2 * offset;
        EXPECT_GE(left, (1 - gamma) * before * (1 - 1e-9)) << trial << " " << r << (all ? " all" : " some");
        closest += left < 1.5 * (1 - gamma) * before;
      }
      bound[r] += bounded(part);
    }
    if (HasFailure()) return;
  }
  for (const int of_rule : bound) EXPECT_GT(of_rule, 400);
  EXPECT_GT(closest, 200) << "no sample comes near to what is promised";
}

/// Two points that run into each other use up exactly gamma of their gap, however they share it.
TEST(BoundsBySampling, UseUpGammaOfTheGapOfTwoPointsHeadOn) {
  Random random(8);
  for (int trial = 0; trial < 100; ++trial) {
    PairScene pair;
    const double gap = random.between(0.1, 0.9) * d_hat;
    // a point over the middle of a triangle that moves as a whole
    add_body(pair.scene, "point", {Vec3d(0, 0, gap)}, {}, d_hat);
    add_body(pair.scene, "triangle", {Vec3d(-1, -1, 0), Vec3d(1, -1, 0), Vec3d(0, 1, 0)}, {{0, 1, 2}}, d_hat);
    pair.n = 4, pair.split = 1;
    const double first = random.between(0.55, 3) * gap, second = random.between(0.55, 3) * gap;
    Positions x1 = pair.scene.x0;
    x1.row(2) += Eigen::RowVector4d(-first, second, second, second);
    for (const StepBoundRule rule : each_rule) {
      const Positions end = taken(random, pair.scene, x1, parts_of(pair.scene, x1, rule), true);
      EXPECT_NEAR(pair.distance(end), (1 - gamma) * gap, 1e-9 * gap) << trial;
    }
  }
}

/// Distance of a simplex and an obstacle at `place`, thickness not taken off; inside: of its farthest vertex and the wall.
double gap_to(const Obstacle& given, const Vec3d& place, const Positions& x, int n) {
  Obstacle o = given;
  o.point = place;
  if (o.kind == ObstacleKind::plane) {
    double least = std::numeric_limits<double>::infinity();
    for (int v = 0; v < n; ++v) least = std::min(least, o.axis.dot(x.col(v) - o.point));
    return least;
  }
  if (!o.inside) return least_gap(o, x.leftCols(n));
  double least = std::numeric_limits<double>::infinity();
  for (int v = 0; v < n; ++v) least = std::min(least, -gap_of_point(o, x.col(v)));
  return least;
}

/// A triangle at an obstacle with a gap of about `gap`: over it, or within it.
Scene triangle_at(Random& random, Obstacle& o, double gap, double offset) {
  const int kind = static_cast<int>(random.rng() % 5);
  const Vec3d n = random.direction(), u = n.unitOrthogonal(), v = n.cross(u);
  o = Obstacle();
  o.name = "obstacle";
  o.kind = kind == 0 ? ObstacleKind::plane : kind % 2 == 1 ? ObstacleKind::sphere : ObstacleKind::cylinder;
  o.inside = kind >= 3;
  o.point = 0.3 * random.direction();
  o.axis = kind == 0 ? n : u;
  o.radius = kind == 0 ? 0 : 1;
  const double out = kind == 0 ? gap + offset : o.inside ? 1 - gap - offset : 1 + gap + offset;
  const Vec3d foot = o.point + out * n, inwards = -0.3 * n;
  const auto raised = [&] {
    return random.rng() % 2 == 0 ? Vec3d(Vec3d::Zero()) : Vec3d(random.between(0, 1) * d_hat * n);
  };
  const std::vector<Vec3d> x =
      o.inside ? std::vector<Vec3d>{foot, foot + 0.3 * v + inwards, foot + 0.3 * u + inwards}
               : std::vector<Vec3d>{foot - 0.5 * v + raised(), foot + 0.5 * v + raised(),
                                    foot + 0.5 * u + raised()};
  Scene scene;
  add_body(scene, "triangle", x, {{0, 1, 2}}, d_hat, false, offset);
  scene.surface_edges = {{0, 1}, {1, 2}, {0, 2}};
  scene.obstacles = {o};
  return scene;
}

TEST(BoundsBySampling, LeaveOfTheGapAtAnObstacleWhatTheyPromise) {
  Random random(9);
  int bound[2] = {0, 0}, kinds[5] = {0, 0, 0, 0, 0}, closest = 0;
  for (int trial = 0; trial < 2500; ++trial) {
    const bool moving = trial % 2 == 1;
    const double offset = trial % 3 == 0 ? 0.4 * d_hat : 0;
    Obstacle o;
    const Scene still = triangle_at(random, o, random.between(0.1, 0.9) * d_hat, offset);
    const Scene scene = moving ? with_moving_obstacles(still) : still;
    const double before = gap_to(o, o.point, scene.x0, 3) - offset;
    if (!(before > 0) || before > d_hat) continue;
    const Vec3d centre = scene.x0.leftCols(3).rowwise().mean();
    const Vec3d arm = o.kind == ObstacleKind::plane ? o.axis
                      : o.kind == ObstacleKind::cylinder
                          ? Vec3d((centre - o.point) - o.axis.dot(centre - o.point) * o.axis)
                          : Vec3d(centre - o.point);
    const Vec3d away = (o.inside ? -1 : 1) * arm.normalized();
    Positions x1 = scene.x0;
    for (int v = 0; v < 3; ++v)
      x1.col(v) += -random.share() * before * away + 0.05 * before * random.unit() * random.direction();
    if (moving) x1.col(3) += random.share() * before * away;
    for (const StepBoundRule rule : each_rule) {
      const std::vector<double> part = parts_of(scene, x1, rule);
      for (const bool all : {true, false}) {
        const Positions end = taken(random, scene, x1, part, all);
        const double left = gap_to(o, moving ? Vec3d(end.col(3)) : o.point, end, 3) - offset;
        EXPECT_GE(left, (1 - gamma) * before * (1 - 1e-7)) << trial << (moving ? " moving" : " still");
        closest += left < 2 * (1 - gamma) * before;
      }
      bound[moving] += bounded(part);
    }
    ++kinds[o.kind == ObstacleKind::plane ? 0
                                          : (o.kind == ObstacleKind::sphere ? 1 : 2) + (o.inside ? 2 : 0)];
    if (HasFailure()) return;
  }
  for (const int of_kind : kinds) EXPECT_GT(of_kind, 40);
  for (const int of_way : bound) EXPECT_GT(of_way, 500);
  EXPECT_GT(closest, 100) << "no sample comes near to what is promised";
}

/// An obstacle that comes from farther than anything reaches is seen: each vertex has a pace of its own.
TEST(BoundsBySampling, SeeAnObstacleThatComesFromAfar) {
  Random random(10);
  for (int trial = 0; trial < 60; ++trial) {
    const double gap = random.between(20, 200) * d_hat;
    Scene still;
    add_body(still, "point", {Vec3d(0.1, 0, gap)}, {}, d_hat);
    Obstacle floor;
    floor.name = "floor";
    still.obstacles = {floor};
    if (trial % 2 == 0) still.obstacles = {round_obstacle(ObstacleKind::sphere, Vec3d(0.1, 0, -1), 1)};
    const Scene scene = with_moving_obstacles(still);
    Positions x1 = scene.x0;
    x1(2, 1) += random.between(1.2, 5) * gap;   // the obstacle comes
    x1(2, 0) += trial % 3 == 0 ? x1(2, 1) : 0;  // and the point goes on before it, or stays
    for (const StepBoundRule rule : each_rule) {
      const std::vector<double> part = parts_of(scene, x1, rule);
      EXPECT_LT(part[1], 1) << trial;
      Positions end = scene.x0;
      end.col(1) += part[1] * (x1.col(1) - scene.x0.col(1));  // the point stays where it was
      const double top = end(2, 1) + (trial % 2 == 0 ? 1 : 0);
      EXPECT_GE(end(2, 0) - top, (1 - gamma) * gap * (1 - 1e-9)) << trial;
    }
  }
}

}  // namespace
}  // namespace bb::test::bounds_by_sampling_test
