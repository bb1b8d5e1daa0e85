// The step bound at balls and bars: no part of a surface comes in before it, by sampling; and it is no shorter than it
// has to be.
#include <gtest/gtest.h>

#include "tests/contact/obstacle_scenes.hpp"

namespace bb::test::obstacle_bound_test {
namespace {

/// The gap of the whole surface stays positive up to the bound; returns the state there.
Positions expect_free_up_to_the_bound(const Scene& scene, const Positions& x0, const Positions& x1,
                                      Precision precision, int* n_bounded) {
  ContactOptions options;
  options.precision = precision;
  ContactSystem contacts(scene, options);
  contacts.update_candidates(x0, x1);
  const StepBound bound = contacts.step_bound(x0, x1);
  const double start = least_gap(scene, x0);
  EXPECT_GT(start, 0);
  EXPECT_GT(bound.alpha, 0);
  for (int k = 1; k <= 12; ++k) {
    const Positions x = x0 + (bound.alpha * k / 12) * (x1 - x0);
    EXPECT_GT(least_gap(scene, x), 0) << "at " << k << "/12 of " << bound.alpha;
  }
  if (bound.alpha == 1) return x1;
  ++*n_bounded;
  EXPECT_GE(bound.kind, ContactKind::obstacle);
  Positions end = x0 + bound.alpha * (x1 - x0);
  if (precision == Precision::full && start > 1e-5) {
    EXPECT_LT(least_gap(scene, end), 1e-6) << "the bound is short";
  }
  return end;
}

Positions free_motion(const Scene& scene, double size, unsigned seed) {
  Positions dx = random_motion(Positions::Zero(3, scene.n_vertices()), size, seed);
  for (const Pin& pin : scene.pins) dx.col(pin.vertex).setZero();
  return dx;
}

TEST(ObstacleBound, KeepsEveryPointOfThickSurfacesOut) {
  int n_bounded = 0, n_motions = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const Scene whole = around_obstacles(seed);
    for (std::size_t t = 0; t < whole.surface_triangles.size(); t += 5) {
      const Scene scene = one_triangle_of(whole, t);
      Positions x = scene.x0;
      for (unsigned k = 0; k < 3; ++k) {  // the second and third begin where the one before was stopped
        x = expect_free_up_to_the_bound(scene, x, x + free_motion(scene, 0.5, seed + 100 * k + unsigned(t)),
                                        Precision::full, &n_bounded);
        ++n_motions;
      }
    }
  }
  EXPECT_GT(n_bounded, n_motions / 3);
}

TEST(ObstacleBound, StopsRodsAndTrianglesWhoseCornersPassBy) {
  for (const ObstacleKind kind : {ObstacleKind::sphere, ObstacleKind::cylinder}) {
    for (const bool rod : {false, true}) {
      Scene scene;
      std::vector<Vec3d> corners{Vec3d(-2, -0.4, 2), Vec3d(2, -0.4, 2), Vec3d(0.9, 3, 2)};
      if (rod) corners = {Vec3d(-2, 0, 2), Vec3d(2, 0, 2)};
      add_body(scene, "body", corners, rod ? Triangles{} : Triangles{{0, 1, 2}}, 0.01, false, 0.05);
      if (rod) scene.surface_edges = {{0, 1}};
      scene.obstacles = {round_obstacle(kind, Vec3d::Zero(), 0.5, Vec3d::UnitY())};
      Positions x1 = scene.x0;
      x1.row(2).array() -= 4;
      ContactSystem contacts(scene, {});
      contacts.update_candidates(scene.x0, x1);
      const StepBound bound = contacts.step_bound(scene.x0, x1);
      EXPECT_NEAR(bound.alpha, (2 - 0.5 - 0.05) / 4, 1e-6) << rod;
      EXPECT_EQ(bound.key[rod || kind == ObstacleKind::cylinder ? 1 : 0], -2);
    }
  }
}

TEST(ObstacleBound, FindsWideTrianglesThatTouchWithASideAndSmallOnesThatFlyIn) {
  for (const ObstacleKind kind : {ObstacleKind::sphere, ObstacleKind::cylinder}) {
    Scene wide;  // its middle is far out, a side is 5 mm away
    add_body(wide, "wide", {Vec3d(-1, 0, 0.505), Vec3d(1, 0.1, 0.505), Vec3d(0, 1, 4)}, {{0, 1, 2}}, 0.01);
    wide.obstacles = {round_obstacle(kind, Vec3d::Zero(), 0.5, Vec3d::UnitY())};
    ContactSystem still(wide, {});
    const double least = least_gap(wide, wide.x0);
    ASSERT_LT(least, 0.01);
    EXPECT_NEAR(rows_at(still, wide.x0).min_gap, least, 1e-9);

    Scene small = wide;
    small.x0.col(0) = Vec3d(-0.02, -0.01, 2), small.x0.col(1) = Vec3d(0.02, -0.01, 2);
    small.x0.col(2) = Vec3d(0.01, 0.02, 2);
    small.rest = small.x0;
    Positions x1 = small.x0;
    x1.row(2).array() -= 4;
    ContactSystem flying(small, {});
    flying.update_candidates(small.x0, x1);
    EXPECT_NEAR(flying.step_bound(small.x0, x1).alpha, 1.5 / 4, 1e-4);
  }
}

TEST(ObstacleBound, StaysOnTheSafeSideInFloat) {
  int n_bounded = 0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Scene whole = around_obstacles(seed);
    for (std::size_t t = 0; t < whole.surface_triangles.size(); t += 5) {
      const Scene scene = one_triangle_of(whole, t);
      const auto rounded = [](const Positions& x) -> Positions { return x.cast<float>().cast<double>(); };
      const Positions x0 = rounded(scene.x0), x1 = rounded(x0 + free_motion(scene, 0.3, seed + unsigned(t)));
      expect_free_up_to_the_bound(scene, x0, x1, Precision::single, &n_bounded);
      ContactOptions in_float;
      in_float.precision = Precision::single;
      ContactSystem contacts(scene, in_float);
      const double least = least_gap(scene, x0);
      if (!(least < 0.079)) continue;
      EXPECT_NEAR(rows_at(contacts, x0).min_gap, least, 1e-5);
    }
  }
  EXPECT_GT(n_bounded, 5);
}

}  // namespace
}  // namespace bb::test::obstacle_bound_test
