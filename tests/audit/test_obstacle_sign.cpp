// Sides of analytic obstacles, exactly on the surface included, and chords that leave the allowed
// set between ends.
#include "core/audit/obstacle_sign.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace bb::audit::obstacle_sign_test {
namespace {

AuditObstacle sphere(const Vec3d& centre, double radius, bool inside) {
  return {ObstacleKind::sphere, centre, Vec3d::UnitZ(), radius, inside};
}

TEST(ObstacleSide, plane_uses_its_normal_as_written) {
  const AuditObstacle plane{ObstacleKind::plane, Vec3d(0, 0, 1), Vec3d(0, 0, 3), 0.0, false};
  EXPECT_EQ(obstacle_side(plane, {9, 9, 1.5}), 1);
  EXPECT_EQ(obstacle_side(plane, {9, 9, 1.0}), 0);
  EXPECT_EQ(obstacle_side(plane, {9, 9, std::nextafter(1.0, 0.0)}), -1);
}

TEST(ObstacleSide, sphere_is_exact_to_the_ulp_outside_and_inside) {
  const AuditObstacle out = sphere(Vec3d(1, 0, 0), 5.0, false), in = sphere(Vec3d(1, 0, 0), 5.0, true);
  const Vec3d on(4, 4, 0), beyond(4, std::nextafter(4.0, 5.0), 0), within(4, std::nextafter(4.0, 3.0), 0);
  EXPECT_EQ(obstacle_side(out, on), 0);
  EXPECT_EQ(obstacle_side(in, on), 0);
  EXPECT_EQ(obstacle_side(out, beyond), 1);
  EXPECT_EQ(obstacle_side(in, beyond), -1);
  EXPECT_EQ(obstacle_side(out, within), -1);
  EXPECT_EQ(obstacle_side(in, within), 1);
}

TEST(ObstacleSide, cylinder_is_infinite_and_takes_any_axis_length) {
  const AuditObstacle c{ObstacleKind::cylinder, Vec3d(0, 0, 0), Vec3d(0, 0, 7), 5.0, false};
  EXPECT_EQ(obstacle_side(c, {3, 4, 100}), 0);
  EXPECT_EQ(obstacle_side(c, {3, std::nextafter(4.0, 5.0), -100}), 1);
  EXPECT_EQ(obstacle_side(c, {3, std::nextafter(4.0, 3.0), -100}), -1);
}

TEST(ObstacleHit, chord_through_a_ball_between_free_ends_is_found) {
  const AuditObstacle ball = sphere(Vec3d::Zero(), 1.0, false);
  EXPECT_TRUE(obstacle_hit(ball, ball, {-2, 0.5, 0}, {2, 0.5, 0}));
  EXPECT_FALSE(obstacle_hit(ball, ball, {-2, 1.0, 0}, {2, 1.0, 0}));  // grazes exactly
  EXPECT_TRUE(obstacle_hit(ball, ball, {-2, std::nextafter(1.0, 0.0), 0}, {2, std::nextafter(1.0, 0.0), 0}));
  EXPECT_FALSE(obstacle_hit(ball, ball, {-2, 0.5, 0}, {-1.5, 0.5, 0}));
  EXPECT_TRUE(obstacle_hit(ball, ball, {0, 0, 0}, {2, 0, 0}));
  EXPECT_TRUE(obstacle_hit(ball, ball, {2, 0, 0}, {0.5, 0, 0}));
}

TEST(ObstacleHit, chord_past_a_tilted_cylinder_far_along_its_axis) {
  const Vec3d axis(1, 2, 2);
  const AuditObstacle c{ObstacleKind::cylinder, Vec3d(5, 0, 0), axis, 1.0, false};
  const Vec3d across(2, -1, 0),
      side(2, 4, -5);  // orthogonal to the axis and to each other; |side| = 3 sqrt 5
  const Vec3d far = c.point + 300.0 * axis;
  EXPECT_TRUE(obstacle_hit(c, c, far - 3.0 * across + 0.1 * side, far + 3.0 * across + 0.1 * side));
  EXPECT_FALSE(obstacle_hit(c, c, far - 3.0 * across + 0.2 * side, far + 3.0 * across + 0.2 * side));
}

TEST(ObstacleHit, inside_sets_are_convex) {
  const AuditObstacle ball = sphere(Vec3d::Zero(), 1.0, true);
  EXPECT_FALSE(obstacle_hit(ball, ball, {-0.9, 0, 0}, {0.9, 0, 0}));
  EXPECT_TRUE(obstacle_hit(ball, ball, {-0.9, 0, 0}, {1.1, 0, 0}));
}

TEST(ObstacleHit, agrees_with_the_distance_of_the_chord_on_random_chords) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-2.0, 2.0);
  const AuditObstacle ball = sphere(Vec3d::Zero(), 1.0, false);
  int hits = 0, misses = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3d a(unit(random), unit(random), unit(random)), b(unit(random), unit(random), unit(random));
    const Vec3d d = b - a;
    const double t = std::clamp(-a.dot(d) / d.squaredNorm(), 0.0, 1.0);
    const double distance = (a + t * d).norm();
    if (std::abs(distance - 1.0) < 1e-9) continue;
    ASSERT_EQ(obstacle_hit(ball, ball, a, b), distance < 1.0);
    ++(distance < 1.0 ? hits : misses);
  }
  EXPECT_GT(hits, 300);
  EXPECT_GT(misses, 300);
}

}  // namespace
}  // namespace bb::audit::obstacle_sign_test
