// Rigid bodies are not compared with themselves; with everything else they are.
#include "core/audit/rigid_reach.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/audit/audit.hpp"

namespace bb::audit::rigid_reach_test {
namespace {

constexpr double tolerance = 1e-9;

/// Clouds of triangles, each a body that is translated and turned as a whole; the last one is free.
struct Clouds {
  AuditMesh mesh;
  Positions x0, x1;
};

Clouds clouds(int bodies, int triangles, std::mt19937& random) {
  std::uniform_real_distribution<double> c(-1.0, 1.0);
  Clouds out;
  const int n = bodies * triangles;
  out.mesh.triangles.resize(3, n);
  out.mesh.edges.resize(2, 3 * n);
  out.x0.resize(3, 3 * n), out.x1.resize(3, 3 * n);
  for (int b = 0; b < bodies; ++b) {
    const Vec3d centre = 1.5 * Vec3d(c(random), c(random), c(random)),
                shift = 0.5 * Vec3d(c(random), c(random), c(random));
    const Mat3d turn =
        Eigen::AngleAxisd(0.4 * c(random), Vec3d(c(random), c(random), 1.5).normalized()).toRotationMatrix();
    for (int t = b * triangles; t < (b + 1) * triangles; ++t) {
      const Vec3d at = 0.6 * Vec3d(c(random), c(random), c(random));
      for (int k = 0; k < 3; ++k) {
        const int v = 3 * t + k;
        out.mesh.triangles(k, t) = v;
        out.mesh.edges.col(v) << v, 3 * t + (k + 1) % 3;
        const Vec3d local = at + 0.4 * Vec3d(c(random), c(random), c(random));
        out.x0.col(v) = centre + local;
        out.x1.col(v) = centre + shift + turn * local;
        out.mesh.motion.push_back(b + 1 < bodies ? b : -1);
      }
    }
  }
  return out;
}

template <class Matrix>
Matrix columns(const Matrix& of, const std::vector<int>& which) {
  Matrix out(of.rows(), static_cast<Eigen::Index>(which.size()));
  for (std::size_t k = 0; k < which.size(); ++k) out.col(static_cast<Eigen::Index>(k)) = of.col(which[k]);
  return out;
}

TEST(RigidReach, what_is_found_between_bodies_is_what_is_found_without_them) {
  std::mt19937 random(14);
  long crossings = 0, violations = 0, spared = 0;
  for (int i = 0; i < 20; ++i) {
    Clouds s = clouds(4, 25, random);
    AuditMesh all = s.mesh;
    all.motion.clear();
    const auto body = [&s](int v) { return s.mesh.motion[static_cast<std::size_t>(v)]; };
    // the pairs of one body, found by leaving out all others
    long own_crossings = 0, own_violations = 0, own_pairs = 0;
    for (int b = 0; b < 3; ++b) {
      AuditMesh one = all;
      std::vector<int> triangles, edges;
      for (int t = 0; t < all.triangles.cols(); ++t) {
        if (body(all.triangles(0, t)) == b) triangles.push_back(t);
      }
      for (int e = 0; e < all.edges.cols(); ++e) {
        if (body(all.edges(0, e)) == b) edges.push_back(e);
      }
      one.triangles = columns(all.triangles, triangles);
      one.edges = columns(all.edges, edges);
      own_crossings += audit_state(one, s.x0, true).crossings;
      const MotionAudit motion = audit_motion(one, s.x0, s.x1, tolerance);
      own_violations += motion.violations, own_pairs += motion.pairs;
    }
    const StateAudit whole = audit_state(all, s.x0, true), between = audit_state(s.mesh, s.x0, false);
    ASSERT_EQ(between.crossings, whole.crossings - own_crossings);
    ASSERT_EQ(between.queries, whole.queries);
    ASSERT_EQ(audit_state(s.mesh, s.x0, true).crossings, whole.crossings) << "the first state looks at all";
    const MotionAudit whole_motion = audit_motion(all, s.x0, s.x1, tolerance);
    const MotionAudit motion = audit_motion(s.mesh, s.x0, s.x1, tolerance);
    ASSERT_EQ(motion.violations, whole_motion.violations - own_violations);
    ASSERT_EQ(motion.pairs, whole_motion.pairs - own_pairs);
    ASSERT_EQ(motion.queries, whole_motion.queries);
    crossings += between.crossings, violations += motion.violations, spared += own_pairs;
  }
  EXPECT_GT(crossings, 100);
  EXPECT_GT(violations, 100);
  EXPECT_GT(spared, 1000);
}

}  // namespace
}  // namespace bb::audit::rigid_reach_test
