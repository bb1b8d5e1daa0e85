// What moves past prescribed bodies that are spared a comparison with themselves: particles, rods and triangles, alone and where
// nothing else is near, in space and in the plane. What is found is what is found when no body is known to be rigid.
#include <gtest/gtest.h>

#include <random>

#include "core/audit/audit.hpp"

namespace bb::audit::prescribed_bodies_test {
namespace {

constexpr double tolerance = 1e-9;

enum class Mover { particle, rod, triangle };

struct Crossing {
  AuditMesh mesh;
  Positions x0, x1;
};

class Builder {
 public:
  explicit Builder(bool planar) { mesh_.planar = planar; }

  /// A body of these points moved by `way`; body -1: free. Shape by the number of points.
  void add(const std::vector<Vec3d>& points, const Vec3d& way, int body) {
    const int first = static_cast<int>(x0_.size()), n = static_cast<int>(points.size());
    for (const Vec3d& p : points) {
      x0_.push_back(p), x1_.push_back(p + way);
      mesh_.motion.push_back(body);
      mesh_.prescribed.push_back(body >= 0);
      mesh_.fixed.push_back(body >= 0 && way.isZero(0));
    }
    if (n == 1) mesh_.points.push_back(first);
    if (n == 2) edges_.push_back({first, first + 1});
    if (n < 3) return;
    for (int k = 0; k < 3; ++k) edges_.push_back({first + k, first + (k + 1) % 3});
    triangles_.push_back({first, first + 1, first + 2});
  }

  Crossing finish() {
    Crossing out{mesh_, Positions(3, static_cast<Eigen::Index>(x0_.size())),
                 Positions(3, static_cast<Eigen::Index>(x0_.size()))};
    for (std::size_t v = 0; v < x0_.size(); ++v) {
      out.x0.col(static_cast<Eigen::Index>(v)) = x0_[v];
      out.x1.col(static_cast<Eigen::Index>(v)) = x1_[v];
    }
    out.mesh.edges.resize(2, static_cast<Eigen::Index>(edges_.size()));
    for (std::size_t e = 0; e < edges_.size(); ++e)
      out.mesh.edges.col(static_cast<Eigen::Index>(e)) << edges_[e][0], edges_[e][1];
    out.mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles_.size()));
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      out.mesh.triangles.col(static_cast<Eigen::Index>(t)) << triangles_[t][0], triangles_[t][1],
          triangles_[t][2];
    return out;
  }

 private:
  AuditMesh mesh_;
  std::vector<Vec3d> x0_, x1_;
  std::vector<std::array<int, 2>> edges_;
  std::vector<std::array<int, 3>> triangles_;
};

Vec3d random_point(std::mt19937& random, double size, bool planar) {
  std::uniform_real_distribution<double> c(-size, size);
  const double x = c(random), y = c(random), z = c(random);
  return {x, y, planar ? 0 : z};
}

/// Given triangles far apart, which stand or move, each met by at most one mover; `through`: most of those pass it.
Crossing past_prescribed_bodies(Mover mover, bool planar, bool through, unsigned seed) {
  std::mt19937 random(seed);
  Builder scene(planar);
  for (int b = 0; b < 6; ++b) {
    const Vec3d centre(40 * b, 0, 0);
    std::vector<Vec3d> body;
    for (const Vec3d& corner : {Vec3d(-1, -1, 0), Vec3d(1, -1, 0), Vec3d(0, 1, 0)})
      body.push_back(centre + corner + random_point(random, 0.2, planar));
    const Vec3d way = b % 2 ? Vec3d(0, 0, 0) : random_point(random, 0.3, planar);
    scene.add(body, way, b);
    if (b == 3) continue;  // nothing is near this one
    const Vec3d from = planar ? Vec3d(0, -3, 0) : Vec3d(0, 0, -2),
                to = through ? Vec3d(-from) : Vec3d(2 * from);
    std::vector<Vec3d> points;
    for (int k = 0; k <= static_cast<int>(mover); ++k)
      points.push_back(centre + from + random_point(random, mover == Mover::particle ? 0.3 : 0.5, planar));
    scene.add(points, to - from, -1);
  }
  return scene.finish();
}

TEST(PrescribedBodies, WhatPassesThemIsFoundWhateverElseIsNear) {
  for (const bool planar : {false, true}) {
    for (const Mover mover : {Mover::particle, Mover::rod, Mover::triangle}) {
      long violations = 0, free = 0;
      for (unsigned seed = 1; seed <= 24; ++seed) {
        const Crossing s = past_prescribed_bodies(mover, planar, seed % 4 != 0, seed);
        AuditMesh unknown = s.mesh;
        unknown.motion.assign(unknown.motion.size(), -1);
        const MotionAudit found = audit_motion(s.mesh, s.x0, s.x1, tolerance);
        const MotionAudit all = audit_motion(unknown, s.x0, s.x1, tolerance);
        ASSERT_EQ(found.violations, all.violations) << planar << static_cast<int>(mover) << " " << seed;
        ASSERT_EQ(found.unproven, all.unproven);
        ASSERT_EQ(found.queries, all.queries);
        ASSERT_EQ(found.first_bad, all.first_bad);
        ASSERT_EQ(found.scene_faults, 0);
        const StateAudit there = audit_state(s.mesh, s.x1, false), whole = audit_state(unknown, s.x1, true);
        ASSERT_EQ(there.crossings, whole.crossings);
        ASSERT_EQ(there.touches, whole.touches);
        violations += found.violations;
        free += found.violations == 0;
      }
      EXPECT_GT(violations, 40) << planar << static_cast<int>(mover);
      EXPECT_GE(free, 6);
    }
  }
}

/// Prescribed bodies that meet each other are the scene's fault, one against itself is not checked after the first state.
TEST(PrescribedBodies, ThatMeetEachOtherAreAFaultAndOneAloneIsNot) {
  int faults = 0;
  for (const bool planar : {false, true}) {
    for (const int other : {0, 1, -1}) {  // the same body, another one, a free one
      Builder scene(planar);
      const Vec3d down = planar ? Vec3d(0, -4, 0) : Vec3d(0, 0, -4);
      scene.add({Vec3d(-1, -1, 0), Vec3d(1, -1, 0), Vec3d(0, 1, 0)}, Vec3d::Zero(), 0);
      scene.add({Vec3d(0.1, 0.1, 0) - down / 2}, down, other);
      const Crossing s = scene.finish();
      const MotionAudit found = audit_motion(s.mesh, s.x0, s.x1, tolerance);
      EXPECT_EQ(found.scene_faults > 0, other == 1) << planar << other;
      EXPECT_EQ(found.violations > 0, other < 0) << planar << other;
      EXPECT_EQ(found.first_fault.has_value(), other == 1);
      EXPECT_EQ(found.first_bad.has_value(), other < 0);
      EXPECT_EQ(found.pairs > 0, other != 0);
      faults += found.scene_faults > 0;
    }
  }
  EXPECT_EQ(faults, 2);
}

/// A free vertex makes what it belongs to the solver's, whoever else is given.
TEST(PrescribedBodies, OneFreeVertexOfAPairMakesItTheSolvers) {
  int judged = 0;
  for (int free = -1; free < 4; ++free) {
    Builder scene(false);
    scene.add({Vec3d(-1, -1, 0), Vec3d(1, -1, 0), Vec3d(0, 1, 0)}, Vec3d::Zero(), 0);
    scene.add({Vec3d(0, 0, 1)}, Vec3d(0, 0, -2), 1);
    Crossing s = scene.finish();
    if (free >= 0) {
      s.mesh.motion[static_cast<std::size_t>(free)] = -1;
      s.mesh.prescribed[static_cast<std::size_t>(free)] = 0;
      s.mesh.fixed[static_cast<std::size_t>(free)] = 0;
    }
    const MotionAudit found = audit_motion(s.mesh, s.x0, s.x1, tolerance);
    EXPECT_EQ(found.violations, free >= 0 ? 1 : 0) << free;
    EXPECT_EQ(found.scene_faults, free >= 0 ? 0 : 1) << free;
    EXPECT_EQ(found.pairs, 1);
    ++judged;
  }
  EXPECT_EQ(judged, 5);
}

}  // namespace
}  // namespace bb::audit::prescribed_bodies_test
