// Motions against their closed forms: rates, scales, keyframes, operations one after the other, and values over time.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "core/model/scene/scene.hpp"

namespace bb::motion_test {
namespace {

const Vec3d x0(1, 2, 3);

Vec3d turned(const Vec3d& axis, double angle, const Vec3d& centre, const Vec3d& x) {
  return centre + Eigen::AngleAxisd(angle, axis) * (x - centre);
}

TEST(Motion, RatesActBetweenStartAndEnd) {
  PrescribedMotion motion;
  motion.velocity = Vec3d(0.5, 0, -1);
  motion.start = 1;
  motion.end = 3;
  EXPECT_FALSE(motion.is_static());
  EXPECT_EQ(motion.pose(0, x0, 0.5), x0);
  EXPECT_EQ(motion.pose(0, x0, 2), Vec3d(x0 + motion.velocity));
  EXPECT_EQ(motion.pose(0, x0, 9), Vec3d(x0 + 2 * motion.velocity));
  EXPECT_EQ(motion.start_velocity(0, x0), Vec3d(0, 0, 0));
  motion.start = 0;
  motion.angular_velocity = 0.7;
  motion.center = Vec3d(0, 1, 0);
  EXPECT_LT(
      (motion.pose(0, x0, 2) - turned(Vec3d::UnitZ(), 1.4, motion.center, x0) - 2 * motion.velocity).norm(),
      1e-15);
  const Vec3d velocity = motion.velocity + 0.7 * Vec3d::UnitZ().cross(x0 - motion.center);
  EXPECT_LT((motion.start_velocity(0, x0) - velocity).norm(), 1e-15);
  EXPECT_EQ(motion.most_turning(), 0.7);
  EXPECT_EQ(motion.last_change(), 3);
}

TEST(Motion, AScaleIsReachedAtTheEnd) {
  PrescribedMotion motion;
  motion.scale = 0.5;
  motion.center = Vec3d(0, 0, 1);
  motion.end = 4;
  EXPECT_TRUE(motion.changes_size());
  EXPECT_LT((motion.pose(0, x0, 1) - (motion.center + 0.875 * (x0 - motion.center))).norm(), 1e-15);
  EXPECT_LT((motion.pose(0, x0, 7) - (motion.center + 0.5 * (x0 - motion.center))).norm(), 1e-15);
  EXPECT_LT((motion.start_velocity(0, x0) + 0.125 * (x0 - motion.center)).norm(), 1e-15);
}

TEST(Motion, SmoothOnesBeginAndEndAtRestAndMeetTheOthersHalfWay) {
  PrescribedMotion motion;
  motion.velocity = Vec3d(2, 0, 0);
  motion.end = 2;
  motion.smooth = true;
  EXPECT_EQ(motion.pose(0, x0, 0), x0);
  EXPECT_NEAR(motion.pose(0, x0, 1)[0], x0[0] + 2, 1e-15);
  EXPECT_NEAR(motion.pose(0, x0, 0.5)[0], x0[0] + 4 * (3 * 0.0625 - 2 * 0.015625), 1e-15);
  EXPECT_NEAR(motion.pose(0, x0, 2)[0], x0[0] + 4, 1e-15);
  EXPECT_EQ(motion.start_velocity(0, x0), Vec3d(0, 0, 0));
  EXPECT_LT((motion.pose(0, x0, 1e-4) - x0).norm(), 1e-7);
}

TEST(Motion, KeyframesSayWhereItIs) {
  PrescribedMotion motion;
  motion.center = Vec3d(1, 1, 0);
  motion.keyframes = {{0, Vec3d::Zero(), 0, 1}, {1, Vec3d(0, 0, 2), 0.5, 1}, {3, Vec3d(4, 0, 2), -0.5, 3}};
  const auto at = [&](double angle, double scale, const Vec3d& way) -> Vec3d {
    return motion.center + scale * (turned(Vec3d::UnitZ(), angle, motion.center, x0) - motion.center) + way;
  };
  EXPECT_EQ(motion.pose(0, x0, -1), x0);
  EXPECT_LT((motion.pose(0, x0, 0.5) - at(0.25, 1, Vec3d(0, 0, 1))).norm(), 1e-15);
  EXPECT_LT((motion.pose(0, x0, 1) - at(0.5, 1, Vec3d(0, 0, 2))).norm(), 1e-15);
  EXPECT_LT((motion.pose(0, x0, 2.5) - at(-0.25, 2.5, Vec3d(3, 0, 2))).norm(), 1e-14);
  EXPECT_LT((motion.pose(0, x0, 8) - at(-0.5, 3, Vec3d(4, 0, 2))).norm(), 1e-14);
  const Vec3d slope = (motion.pose(0, x0, 1e-7) - motion.pose(0, x0, 0)) / 1e-7;
  ASSERT_GT(slope.norm(), 1);
  EXPECT_LT((motion.start_velocity(0, x0) - slope).norm(), 1e-6);
  EXPECT_EQ(motion.most_turning(), 0.5);
  EXPECT_EQ(motion.last_change(), 3);
  motion.smooth = true;
  EXPECT_LT((motion.pose(0, x0, 0.25) - at(0.5 * 0.15625, 1, Vec3d(0, 0, 2 * 0.15625))).norm(), 1e-15);
  EXPECT_EQ(motion.most_turning(), 0.75);
}

TEST(Motion, OperationsFollowOneAnotherInTheirOrder) {
  PrescribedMotion motion;  // a quarter of a turn about z in the first second, then a way along x
  motion.angular_velocity = std::acos(0.0);
  motion.end = 1;
  MotionStep way;
  way.velocity = Vec3d(1, 0, 0);
  motion.then = {way};
  EXPECT_LT((motion.pose(0, x0, 2) - Vec3d(-2 + 2, 1, 3)).norm(), 1e-14);
  PrescribedMotion other;  // the way first: it is turned too
  other.velocity = way.velocity;
  other.then = {static_cast<const MotionStep&>(motion)};
  EXPECT_LT((other.pose(0, x0, 2) - Vec3d(-2, 3, 3)).norm(), 1e-14);
  EXPECT_FALSE(same_motion(motion, other));
  EXPECT_TRUE(same_motion(motion, PrescribedMotion(motion)));
  const Vec3d slope = (motion.pose(0, x0, 1e-7) - x0) / 1e-7;
  EXPECT_LT((motion.start_velocity(0, x0) - slope).norm(), 1e-6);
  PrescribedMotion moved = motion;
  moved.translate(Vec3d(0, 0, 5));
  EXPECT_LT((moved.pose(0, x0 + Vec3d(0, 0, 5), 2) - motion.pose(0, x0, 2) - Vec3d(0, 0, 5)).norm(), 1e-14);
}

TEST(Motion, ValuesOverTimeAreLinearBetweenKeysAndConstantOutside) {
  const std::vector<GravityKey> keys = {{1, Vec3d(0, 0, -10)}, {2, Vec3d(0, 4, 10)}};
  EXPECT_EQ(value_at(keys, 0), Vec3d(0, 0, -10));
  EXPECT_EQ(value_at(keys, 1.25), Vec3d(0, 1, -5));
  EXPECT_EQ(value_at(keys, 2), Vec3d(0, 4, 10));
  EXPECT_EQ(value_at(keys, 5), Vec3d(0, 4, 10));
  Scene scene;
  scene.gravity = Vec3d(1, 0, 0);
  EXPECT_EQ(gravity_at(scene, 3), Vec3d(1, 0, 0));
  scene.gravity_keys = keys;
  EXPECT_EQ(gravity_at(scene, 1.5), Vec3d(0, 2, 0));
}

}  // namespace
}  // namespace bb::motion_test
