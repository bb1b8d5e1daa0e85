// Analytic obstacles: signs, derivatives and the first time a motion comes down to a level.
#include <gtest/gtest.h>

#include <random>

#include "core/contact/obstacle.hpp"
#include "core/contact/obstacle_motion.hpp"

namespace bb::obstacles_test {
namespace {

Obstacle make(ObstacleKind kind, bool inside) {
  Obstacle o;
  o.kind = kind;
  o.point = Vec3d(0.1, -0.2, 0.3);
  o.axis = Vec3d(1, 2, 2) / 3.0;
  o.radius = kind == ObstacleKind::plane ? 0 : 1.5;
  o.inside = inside;
  return o;
}

std::vector<Obstacle> all_kinds() {
  return {make(ObstacleKind::plane, false), make(ObstacleKind::sphere, false),
          make(ObstacleKind::sphere, true), make(ObstacleKind::cylinder, false),
          make(ObstacleKind::cylinder, true)};
}

/// A vertex that falls from `height` to -height over a floor whose point is so far along x.
double falling(double height, double park, double far) {
  Obstacle floor;
  floor.point = Vec3d(far, 0, 0);
  floor.axis = Vec3d::UnitZ();
  return obstacle_toi(analytic_surface<double>(floor), analytic_surface<double>(floor), Vec3d(far, 0, height),
                      Vec3d(far, 0, -height), 0, park);
}

TEST(Obstacle, AVertexStopsAtTheParkOrAtHalfItsGap) {
  EXPECT_NEAR(falling(1, 1e-3, 0), (1 - 1e-3) / 2, 1e-12);
  EXPECT_NEAR(falling(1.5e-3, 1e-3, 0), 0.25, 1e-12);  // below twice the park
  EXPECT_NEAR(falling(0.5e-3, 1e-3, 0), 0.25, 1e-12);  // below the park itself: it can move all the same
  EXPECT_EQ(falling(0, 1e-3, 0), 0);
}

TEST(Obstacle, FarFromTheOriginAVertexStopsAboveItsRounding) {
  const double far = 1e6, floor = ulp_floor(far);
  EXPECT_GT(floor, 1e-9);
  EXPECT_NEAR(falling(1, 1e-15, far), (1 - floor) / 2, 0.1 * floor);
}

TEST(Obstacle, GapAndNormalByHand) {
  Obstacle o;
  o.axis = Vec3d::UnitX();
  o.radius = 2;
  const Vec3d x(3, 4, 0);

  EXPECT_EQ(surface_gap<double>(analytic_surface<double>(o), x).d, 3);
  o.kind = ObstacleKind::sphere;
  const auto outside = surface_gap<double>(analytic_surface<double>(o), x);
  EXPECT_EQ(outside.d, 3);
  EXPECT_NEAR((outside.normal - Vec3d(0.6, 0.8, 0)).norm(), 0, 1e-15);
  o.inside = true;
  const auto inside = surface_gap<double>(analytic_surface<double>(o), x);
  EXPECT_EQ(inside.d, -3);
  EXPECT_NEAR((inside.normal + Vec3d(0.6, 0.8, 0)).norm(), 0, 1e-15);
  o.kind = ObstacleKind::cylinder;
  o.inside = false;
  const auto cylinder = surface_gap<double>(analytic_surface<double>(o), x);
  EXPECT_EQ(cylinder.d, 2);
  EXPECT_NEAR((cylinder.normal - Vec3d(0, 1, 0)).norm(), 0, 1e-15);
  EXPECT_EQ(cylinder.curvature, 0.25);
}

TEST(Obstacle, DerivativesMatchFiniteDifferences) {
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<double> unit(-2, 2);
  int curved = 0;
  for (const Obstacle& o : all_kinds()) {
    const auto s = analytic_surface<double>(o);
    for (int sample = 0; sample < 5; ++sample) {
      const Vec3d x(unit(rng), unit(rng), unit(rng));
      const auto gap = surface_gap<double>(s, x);
      const Mat3d hessian = gap.curvature * (Mat3d::Identity() - gap.normal * gap.normal.transpose() -
                                             gap.flat * gap.flat.transpose());
      EXPECT_NEAR(gap.normal.norm(), 1, 1e-15);
      const double h = 1e-5;
      for (int k = 0; k < 3; ++k) {
        const auto up = surface_gap<double>(s, Vec3d(x + h * Vec3d::Unit(k)));
        const auto down = surface_gap<double>(s, Vec3d(x - h * Vec3d::Unit(k)));
        EXPECT_NEAR((up.d - down.d) / (2 * h), gap.normal[k], 1e-9);
        EXPECT_LT(((up.normal - down.normal) / (2 * h) - hessian.col(k)).norm(), 1e-8);
      }
      curved += hessian.norm() > 0.1;
    }
  }
  EXPECT_EQ(curved, 20);  // all but the plane
}

TEST(Obstacle, FirstTimeIsNeverLateAndExact) {
  std::mt19937_64 rng(2);
  std::uniform_real_distribution<double> unit(-3, 3);
  const double level = 0.01;
  int hits = 0, misses = 0;
  for (const Obstacle& o : all_kinds()) {
    const auto s = analytic_surface<double>(o);
    for (int sample = 0; sample < 400; ++sample) {
      const Vec3d x0(unit(rng), unit(rng), unit(rng)), x1(unit(rng), unit(rng), unit(rng));
      if (!(surface_gap<double>(s, x0).d > level)) continue;
      const double t = first_time_at<double>(s, s, x0, x1, level);
      const auto gap = [&](double time) { return surface_gap<double>(s, Vec3d(x0 + time * (x1 - x0))).d; };
      for (int k = 0; k < 200; ++k) ASSERT_GT(gap(t * k / 200), level);
      if (t < 1) {
        ++hits;
        EXPECT_GE(gap(t), level - 1e-15);
        EXPECT_NEAR(gap(t), level, 1e-12);
      } else {
        ++misses;
        EXPECT_GT(gap(1), level);
      }
    }
  }
  EXPECT_GT(hits, 300);
  EXPECT_GT(misses, 300);
}

TEST(Obstacle, GrazingMotionsStopOnlyWhenTheyReachTheLevel) {
  Obstacle o;
  o.kind = ObstacleKind::sphere;
  o.radius = 1;
  const auto s = analytic_surface<double>(o);
  const auto pass = [&](double height) {
    return first_time_at<double>(s, s, Vec3d(-2, 0, height), Vec3d(2, 0, height), 0.0);
  };
  EXPECT_EQ(pass(1 + 1e-9), 1);
  EXPECT_NEAR(pass(1 - 1e-9), 0.5, 1e-4);
  EXPECT_LT(pass(1 - 1e-9), 0.5);
}

TEST(Obstacle, TimeZeroWhenTheStartIsNotAboveTheLevel) {
  for (const Obstacle& o : all_kinds()) {
    const auto s = analytic_surface<double>(o);
    const Vec3d axis = o.kind == ObstacleKind::cylinder ? Vec3d(2, -2, 1) / 3.0 : o.axis;
    const Vec3d on = o.point + o.radius * axis;
    EXPECT_EQ(first_time_at<double>(s, s, on, Vec3d(on + axis), 0.01), 0);
    EXPECT_EQ(first_time_at<double>(s, s, Vec3d(on + (o.inside ? -1.0 : 1.0) * axis), on, 0.5) < 1, true);
  }
}

TEST(Obstacle, NoMotionNeverHits) {
  for (const Obstacle& o : all_kinds()) {
    const auto s = analytic_surface<double>(o);
    const Vec3d x = o.inside ? Vec3d(o.point + Vec3d(0.1, 0, 0)) : Vec3d(4, 4, 4);
    EXPECT_EQ(first_time_at<double>(s, s, x, x, 0.01), 1);
  }
}

}  // namespace
}  // namespace bb::obstacles_test
