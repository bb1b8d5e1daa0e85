// Which pairs a motion is judged by and whom it names, whoever of a pair moves, is given or stands still; and the gap to what
// is given. Against every pair by itself.
#include <gtest/gtest.h>

#include <bit>
#include <random>

#include "core/audit/audit.hpp"
#include "core/audit/box_tree.hpp"
#include "core/audit/obstacle_sign.hpp"
#include "core/audit/pair_verdict.hpp"
#include "core/audit/surface_edges.hpp"
#include "tests/audit/small_scenes.hpp"
#include "tests/contact/true_pairs.hpp"

namespace bb::audit::who_is_judged_test {
namespace {

constexpr double tolerance = 1e-9;

Vec3d random_point(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> c(-size, size);
  const double x = c(random), y = c(random);
  return {x, y, c(random)};
}

/// Two triangles, the second above the first and below it at the end as far as its vertices move.
struct TwoTriangles {
  AuditMesh mesh;
  Positions x0 = Positions(3, 6), x1;
};

TwoTriangles moving_triangles(unsigned moving, std::mt19937& random) {
  TwoTriangles out;
  out.mesh = two_triangles();
  for (int v = 0; v < 6; ++v) out.x0.col(v) = random_point(random, 1) + Vec3d(0, 0, v < 3 ? 0 : 0.7);
  out.x1 = out.x0;
  for (int v = 0; v < 6; ++v) {
    if ((moving >> v & 1U) != 0) out.x1.col(v) += Vec3d(0, 0, v < 3 ? 1.5 : -1.5) + random_point(random, 0.3);
  }
  return out;
}

struct Counts {
  long pairs = 0, certified = 0, violations = 0, unproven = 0;
};

template <class Pair>
void count(const TwoTriangles& s, const std::array<int, 4>& ids, Counts& out) {
  if (std::all_of(ids.begin(), ids.end(), [&s](int v) { return s.x0.col(v) == s.x1.col(v); })) return;
  PairMotion<Pair> motion;
  bool apart = false;
  for (std::size_t k = 0; k < 4; ++k) motion.x0[k] = s.x0.col(ids[k]), motion.x1[k] = s.x1.col(ids[k]);
  Box first, second;
  for (std::size_t k = 0; k < 4; ++k) {
    Box& box = k < (Pair::n_corners == 4 ? 2U : 1U) ? first : second;
    box.add(motion.x0[k]), box.add(motion.x1[k]);
  }
  apart = !first.meets(second);
  if (apart) return;
  ++out.pairs;
  const Verdict verdict = judge(motion, tolerance);
  ++(verdict == Verdict::certified   ? out.certified
     : verdict == Verdict::violation ? out.violations
                                     : out.unproven);
}

Counts every_pair(const TwoTriangles& s) {
  Counts out;
  for (int v = 0; v < 6; ++v) {
    const int f = v < 3 ? 3 : 0;
    count<VertexTriangle>(s, {v, f, f + 1, f + 2}, out);
  }
  for (int e = 0; e < 3; ++e) {
    for (int f = 3; f < 6; ++f) {
      count<EdgeEdge>(s, {s.mesh.edges(0, e), s.mesh.edges(1, e), s.mesh.edges(0, f), s.mesh.edges(1, f)},
                      out);
    }
  }
  return out;
}

TEST(WhoIsJudged, EveryPairOfWhichAnyVertexMoves) {
  std::mt19937 random(4);
  Counts sum;
  int one_moves = 0;
  for (unsigned i = 0; i < 640; ++i) {
    const TwoTriangles s = moving_triangles(i % 64, random);
    const Counts expected = every_pair(s);
    const MotionAudit found = audit_motion(s.mesh, s.x0, s.x1, tolerance);
    ASSERT_EQ(found.pairs, expected.pairs) << "moving " << i % 64;
    ASSERT_EQ(found.certified, expected.certified) << "moving " << i % 64;
    ASSERT_EQ(found.violations, expected.violations) << "moving " << i % 64;
    ASSERT_EQ(found.unproven, expected.unproven);
    EXPECT_EQ(found.first_bad.has_value(), expected.violations > 0);
    EXPECT_EQ(found.pairs == 0, expected.pairs == 0);
    sum.violations += expected.violations, sum.certified += expected.certified;
    one_moves += expected.violations > 0 && std::has_single_bit(i % 64);
  }
  EXPECT_GT(sum.violations, 300);
  EXPECT_GT(sum.certified, 300);
  EXPECT_GT(one_moves, 15);
}

/// A corner that goes into the ball and out of it again is named, though both of its ends are free.
TEST(WhoIsJudged, AVertexThatPassesThroughAnObstacleIsNamed) {
  std::mt19937 random(6);
  AuditMesh mesh;
  mesh.triangles = Eigen::Vector3i(0, 1, 2);
  mesh.edges.resize(2, 3);
  mesh.edges << 0, 1, 2, 1, 2, 0;
  int by_vertex = 0, between = 0, free = 0, out_again = 0;
  for (int i = 0; i < 400; ++i) {
    AuditObstacle o;
    o.kind = i % 2 ? ObstacleKind::sphere : ObstacleKind::cylinder;
    o.radius = 0.3, o.axis = Vec3d(0.1, 2, 0.3);
    mesh.obstacles = {o};
    Positions x0(3, 3), x1(3, 3);
    for (int v = 0; v < 3; ++v) {
      x0.col(v) = random_point(random, 1) + Vec3d(0, 0, 2);
      x1.col(v) = random_point(random, 1) - Vec3d(0, 0, i % 5 == 0 ? -2 : 2);
    }
    int lowest = -1;
    for (int v = 2; v >= 0; --v) {
      if (obstacle_hit(o, o, x0.col(v), x1.col(v))) lowest = v;
    }
    const MotionAudit found = audit_motion(mesh, x0, x1, tolerance);
    ASSERT_EQ(found.obstacle_unproven, 0);
    ASSERT_EQ(found.obstacle_by_vertex, lowest >= 0) << i;
    if (lowest >= 0) {
      ASSERT_TRUE(found.first_bad);
      EXPECT_EQ(*found.first_bad, (PairName{PairKind::vertex_obstacle, lowest, 0}));
      out_again += obstacle_side(o, x1.col(lowest)) > 0;
    } else if (found.first_bad) {
      EXPECT_EQ(*found.first_bad, (PairName{PairKind::triangle_obstacle, 0, 0}));
      ++between;
    }
    by_vertex += lowest >= 0, free += found.obstacle_violations == 0;
  }
  EXPECT_GT(by_vertex, 50);
  EXPECT_GT(out_again, 50);
  EXPECT_GT(between, 50);
  EXPECT_GT(free, 50);
}

double gap_by_pairs(const AuditMesh& mesh, const Positions& x) {
  const auto corners = [&x](const auto& ids) {
    test::Corners out(3, ids.size());
    for (Eigen::Index k = 0; k < ids.size(); ++k) out.col(k) = x.col(ids[k]);
    return out;
  };
  const auto thick = [&mesh](const auto& ids) {
    double sum = 0;
    for (const int v : ids) sum += mesh.thickness[static_cast<std::size_t>(v)];
    return sum / static_cast<double>(ids.size());
  };
  double least = std::numeric_limits<double>::infinity();
  const auto take = [&](const auto& a, const auto& b) {
    if (mesh.all_prescribed(a) && mesh.all_prescribed(b)) return;
    least = std::min(least, test::true_closest(corners(a), corners(b)).d - thick(a) - thick(b));
  };
  for (int v = 0; v < 6; ++v)
    take(Eigen::Matrix<int, 1, 1>(v), Eigen::Vector3i(mesh.triangles.col(v < 3 ? 1 : 0)));
  for (int e = 0; e < 3; ++e) {
    for (int f = 3; f < 6; ++f) take(Eigen::Vector2i(mesh.edges.col(e)), Eigen::Vector2i(mesh.edges.col(f)));
  }
  return least;
}

/// The gap of every pair with a vertex that is not given counts, thick or not; of given ones alone none does.
TEST(WhoIsJudged, TheGapToWhatIsGivenCounts) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> thickness(0, 0.1);
  int mixed = 0, none = 0, other = 0;
  for (unsigned i = 0; i < 192; ++i) {
    TwoTriangles s = moving_triangles(0, random);
    for (unsigned v = 0; v < 6; ++v) {
      s.mesh.prescribed.push_back(i >> v & 1U);
      s.mesh.thickness.push_back(thickness(random));
    }
    const double expected = gap_by_pairs(s.mesh, s.x0);
    const double found =
        surface_gap(s.mesh, colliding_vertices(s.mesh), obstacle_primitives(s.mesh), s.x0, 5).between;
    if (std::isinf(expected)) {
      EXPECT_EQ(found, expected);
      ++none;
      continue;
    }
    EXPECT_NEAR(found, expected, 1e-12) << i;
    mixed += i % 64 != 0;
    AuditMesh nobody = s.mesh;
    nobody.prescribed.clear();
    other += std::abs(gap_by_pairs(nobody, s.x0) - expected) > 1e-6;
  }
  EXPECT_GT(mixed, 120);
  EXPECT_EQ(none, 3);
  EXPECT_GT(other, 10);
}

}  // namespace
}  // namespace bb::audit::who_is_judged_test
