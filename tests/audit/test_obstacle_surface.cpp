// Triangles and edges against spheres and cylinders: exact signs against a brute force in rationals and against dense
// samples, motions against samples of time, on random and on degenerate configurations.
#include <gmpxx.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>

#include "core/audit/obstacle_motion.hpp"
#include "core/audit/obstacle_sign.hpp"

namespace bb::audit::obstacle_surface_test {
namespace {

using Triangle = std::array<Vec3d, 3>;
using Q3 = std::array<mpq_class, 3>;

AuditObstacle sphere(double radius) {
  return {ObstacleKind::sphere, Vec3d::Zero(), Vec3d::UnitZ(), radius, false};
}

bool cuts(const AuditObstacle& o, const Triangle& t) { return obstacle_cuts(o, t[0], t[1], t[2]); }

bool every_vertex_is_free(const AuditObstacle& o, const Triangle& t) {
  return obstacle_side(o, t[0]) > 0 && obstacle_side(o, t[1]) > 0 && obstacle_side(o, t[2]) > 0;
}

// --- brute force: the least squared distance over all faces of the simplex, each by its normal equations

mpq_class dot(const Q3& a, const Q3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Q3 minus(const Q3& a, const Q3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

/// Offset from the centre, or from the axis at right angles to it.
Q3 offset(const AuditObstacle& o, const Vec3d& x) {
  Q3 r;
  for (std::size_t k = 0; k < 3; ++k)
    r[k] = mpq_class(x[static_cast<int>(k)]) - mpq_class(o.point[static_cast<int>(k)]);
  if (o.kind == ObstacleKind::sphere) return r;
  const Q3 a{mpq_class(o.axis[0]), mpq_class(o.axis[1]), mpq_class(o.axis[2])};
  const mpq_class along = dot(r, a) / dot(a, a);
  for (std::size_t k = 0; k < 3; ++k) r[k] -= along * a[k];
  return r;
}

std::optional<mpq_class> least_on_edge(const Q3& a, const Q3& b) {
  const Q3 u = minus(b, a);
  const mpq_class uu = dot(u, u);
  if (sgn(uu) == 0) return std::nullopt;
  const mpq_class s = -dot(a, u) / uu;
  if (sgn(s) < 0 || s > 1) return std::nullopt;
  const Q3 foot{a[0] + s * u[0], a[1] + s * u[1], a[2] + s * u[2]};
  return dot(foot, foot);
}

std::optional<mpq_class> least_on_face(const Q3& a, const Q3& b, const Q3& c) {
  const Q3 u = minus(b, a), v = minus(c, a);
  const mpq_class uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), au = dot(a, u), av = dot(a, v);
  const mpq_class det = uu * vv - uv * uv;
  if (sgn(det) == 0) return std::nullopt;
  const mpq_class s = (uv * av - vv * au) / det, t = (uv * au - uu * av) / det;
  if (sgn(s) < 0 || sgn(t) < 0 || s + t > 1) return std::nullopt;
  Q3 foot;
  for (std::size_t k = 0; k < 3; ++k) foot[k] = a[k] + s * u[k] + t * v[k];
  return dot(foot, foot);
}

bool brute_cuts(const AuditObstacle& o, const Triangle& t) {
  const Q3 a = offset(o, t[0]), b = offset(o, t[1]), c = offset(o, t[2]);
  mpq_class least = dot(a, a);
  for (const auto& other :
       {std::optional<mpq_class>(dot(b, b)), std::optional<mpq_class>(dot(c, c)), least_on_edge(a, b),
        least_on_edge(b, c), least_on_edge(c, a), least_on_face(a, b, c)}) {
    if (other && *other < least) least = *other;
  }
  return least < mpq_class(o.radius) * mpq_class(o.radius);
}

// --- states

TEST(ObstacleCuts, a_coarse_triangle_over_a_ball_has_its_vertices_and_edges_outside) {
  const AuditObstacle ball = sphere(1.0);
  const Triangle t{Vec3d(-4, -4, 0.9), Vec3d(4, -4, 0.9), Vec3d(0, 6, 0.9)};
  EXPECT_TRUE(every_vertex_is_free(ball, t));
  for (std::size_t k = 0; k < 3; ++k) EXPECT_FALSE(obstacle_hit(ball, ball, t[k], t[(k + 1) % 3]));
  EXPECT_TRUE(cuts(ball, t));
  const AuditObstacle rod{ObstacleKind::cylinder, Vec3d::Zero(), Vec3d(0, 0, 2), 0.5, false};
  EXPECT_TRUE(every_vertex_is_free(rod, t));
  EXPECT_TRUE(cuts(rod, t)) << "the axis pierces it";
}

TEST(ObstacleCuts, tangent_is_free_and_an_ulp_less_is_not) {
  const AuditObstacle ball = sphere(5.0);
  const double below = std::nextafter(5.0, 0.0);
  const auto flat = [](double z) { return Triangle{Vec3d(-4, -3, z), Vec3d(5, -2, z), Vec3d(0, 7, z)}; };
  EXPECT_FALSE(cuts(ball, flat(5.0)));
  EXPECT_TRUE(cuts(ball, flat(below)));
  const auto by_edge = [](double z) { return Triangle{Vec3d(-9, 3, z), Vec3d(9, 3, z), Vec3d(0, 9, z + 9)}; };
  EXPECT_FALSE(cuts(ball, by_edge(4.0)));
  EXPECT_TRUE(cuts(ball, by_edge(std::nextafter(4.0, 0.0))));
  const auto by_vertex = [](double y) { return Triangle{Vec3d(3, y, 0), Vec3d(6, 8, 1), Vec3d(6, 8, -1)}; };
  EXPECT_FALSE(cuts(ball, by_vertex(4.0)));
  EXPECT_TRUE(cuts(ball, by_vertex(std::nextafter(4.0, 0.0))));
}

TEST(ObstacleCuts, convex_sets_ask_the_vertices) {
  AuditObstacle ball = sphere(5.0);
  ball.inside = true;
  EXPECT_FALSE(cuts(ball, {Vec3d(3, 4, 0), Vec3d(-3, 4, 0), Vec3d(0, -5, 0)}));
  EXPECT_TRUE(cuts(ball, {Vec3d(3, 4, 1e-7), Vec3d(-3, 4, 0), Vec3d(0, -5, 0)}));
}

// Integers up to 3 and radii whose squares are integers make every kind of tangency and every kind of degenerate triangle.
TEST(ObstacleCuts, agrees_with_rational_brute_force_on_degenerate_triangles) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> c(-3, 3), r(1, 3), kind(0, 1);
  int hidden = 0, cut = 0, touching = 0;
  for (int i = 0; i < 30000; ++i) {
    const auto point = [&] { return Vec3d(c(random), c(random), c(random)); };
    AuditObstacle o = sphere(r(random));
    if (kind(random) == 1) {
      o.kind = ObstacleKind::cylinder;
      do o.axis = point();
      while (o.axis.isZero());
    }
    o.point = point();
    const Triangle t{point(), point(), point()};
    const bool expected = brute_cuts(o, t);
    ASSERT_EQ(cuts(o, t), expected) << t[0].transpose() << ", " << t[1].transpose() << ", "
                                    << t[2].transpose();
    AuditObstacle wider = o;
    wider.radius = std::nextafter(o.radius, 9.0);
    touching += !expected && brute_cuts(wider, t);
    hidden += expected && every_vertex_is_free(o, t);
    cut += expected;
  }
  EXPECT_GT(cut, 3000);
  EXPECT_GT(hidden, 300);  // what an audit of vertices does not see
  EXPECT_GT(touching, 300);
}

Vec3d unit_vector(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Vec3d v;
  do v = Vec3d(normal(random), normal(random), normal(random));
  while (!(v.norm() > 1e-3));
  return v.normalized();
}

// Triangles at a wanted distance from the surface, seen by one of their faces, edges or corners.
Triangle triangle_at(double distance, int feature, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0.05, 1.0);
  const Vec3d n = unit_vector(random), u = n.unitOrthogonal(), v = n.cross(u), foot = distance * n;
  const double a = unit(random), b = unit(random), c = unit(random);
  switch (feature) {
    case 0:
      return {foot + a * u, foot - b * u + c * v, foot - b * u - a * v};
    case 1:
      return {foot + a * u, foot - b * u, foot + c * n + 0.3 * v};
    default:
      return {foot, foot + a * n + b * u, foot + c * n + a * v};
  }
}

TEST(ObstacleCuts, agrees_with_dense_samples_near_the_surface) {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> spread(-12.0, -1.0);
  int free = 0, cut = 0;
  for (int i = 0; i < 3000; ++i) {
    const AuditObstacle ball = sphere(0.4);
    const double gap = std::pow(10.0, spread(random)) * (i % 2 == 0 ? 1 : -1);
    const Triangle t = triangle_at(0.4 + gap, i % 3, random);
    ASSERT_EQ(cuts(ball, t), gap < 0) << gap;
    double least = 1e9;
    for (int p = 0; p <= 20; ++p) {
      for (int q = 0; q <= 20 - p; ++q) {
        least = std::min(least, (t[0] + p / 20.0 * (t[1] - t[0]) + q / 20.0 * (t[2] - t[0])).norm());
      }
    }
    ASSERT_FALSE(least < 0.4 - 1e-12 && gap > 0);
    ++(gap < 0 ? cut : free);
  }
  EXPECT_EQ(free, 1500);
  EXPECT_EQ(cut, 1500);
}

// --- motions

template <std::size_t N>
double least_on_the_way(const AuditObstacle& o, const std::array<Vec3d, N>& x0,
                        const std::array<Vec3d, N>& x1) {
  double least = 1e9;
  for (int k = 0; k <= 200; ++k) {
    std::array<Vec3d, N> x;
    for (std::size_t i = 0; i < N; ++i) x[i] = x0[i] + k / 200.0 * (x1[i] - x0[i]);
    for (int p = 0; p <= 12; ++p) {
      for (int q = 0; q <= (N == 3 ? 12 - p : 0); ++q) {
        Vec3d y = x[0] + p / 12.0 * (x[1] - x[0]);
        if constexpr (N == 3) y += q / 12.0 * (x[2] - x[0]);
        Vec3d w = y - o.point;
        if (o.kind == ObstacleKind::cylinder) w -= o.axis * (o.axis.dot(w) / o.axis.squaredNorm());
        least = std::min(least, w.norm());
      }
    }
  }
  return least;
}

template <std::size_t N>
void compare_with_samples(ObstacleKind kind) {
  std::mt19937 random(77);
  std::uniform_real_distribution<double> c(-1.0, 1.0);
  int seen[3] = {0, 0, 0};
  for (int i = 0; i < 1500; ++i) {
    const auto point = [&] { return Vec3d(c(random), c(random), c(random)); };
    const AuditObstacle o{kind, 0.3 * point(), point() + Vec3d(0, 0, 1.5), 0.25, false};
    std::array<Vec3d, N> x0, x1;
    const Vec3d shift = 0.7 * point();
    for (std::size_t k = 0; k < N; ++k) x0[k] = point() + shift, x1[k] = x0[k] + 0.7 * point();
    const Verdict verdict = judge_past_obstacle<N>(o, o, x0, x1);
    const double least = least_on_the_way<N>(o, x0, x1);
    ++seen[static_cast<int>(verdict)];
    if (least < o.radius - 1e-9) {
      ASSERT_EQ(verdict, Verdict::violation) << least;
    }
    if (least > o.radius + 0.15) {
      ASSERT_EQ(verdict, Verdict::certified) << least;
    }
    const Verdict back = judge_past_obstacle<N>(o, o, x1, x0);
    ASSERT_EQ(verdict, back);
  }
  EXPECT_GT(seen[static_cast<int>(Verdict::certified)], 200);
  EXPECT_GT(seen[static_cast<int>(Verdict::violation)], 150);
  EXPECT_EQ(seen[static_cast<int>(Verdict::unproven)], 0);
}

TEST(PastObstacle, triangles_and_edges_agree_with_samples) {
  compare_with_samples<3>(ObstacleKind::sphere);
  compare_with_samples<3>(ObstacleKind::cylinder);
  compare_with_samples<2>(ObstacleKind::sphere);
  compare_with_samples<2>(ObstacleKind::cylinder);
}

/// Slides along the tangent, at its middle closest, with both ends free.
TEST(PastObstacle, a_triangle_that_slides_over_a_ball_is_decided_down_to_small_gaps) {
  std::mt19937 random(3);
  const AuditObstacle ball = sphere(1.0);
  int certified = 0, violations = 0;
  for (int i = 0; i < 300; ++i) {
    const double gap = std::pow(10.0, -3.0 - 3.0 * (i % 3)) * (i % 2 == 0 ? 1 : -1);
    const Vec3d n = unit_vector(random), u = n.unitOrthogonal(), v = n.cross(u);
    const Vec3d foot = (1.0 + gap) * n, way = 0.2 * u;
    const Triangle middle{foot + 0.02 * v, foot + 0.03 * u - 0.01 * v + 0.01 * n,
                          foot - 0.02 * u - 0.02 * v + 0.01 * n};
    Triangle x0, x1;  // the corner foot + 0.02 v is farther: the edge at the foot decides
    for (std::size_t k = 0; k < 3; ++k) x0[k] = middle[k] - way, x1[k] = middle[k] + way;
    x0[0] = foot - way, x1[0] = foot + way;
    ASSERT_FALSE(cuts(ball, x0) || cuts(ball, x1));
    const Verdict verdict = judge_past_obstacle<3>(ball, ball, x0, x1);
    ASSERT_EQ(verdict, gap > 0 ? Verdict::certified : Verdict::violation) << gap;
    ++(gap > 0 ? certified : violations);
  }
  EXPECT_EQ(certified, 150);
  EXPECT_EQ(violations, 150);
}

TEST(PastObstacle, exact_ends_and_a_mere_touch) {
  const AuditObstacle ball = sphere(5.0);
  const Triangle far{Vec3d(-4, -3, 9), Vec3d(5, -2, 9), Vec3d(0, 7, 9)};
  const auto down_to = [&far](double z) {
    Triangle t = far;
    for (Vec3d& x : t) x[2] = z;
    return t;
  };
  EXPECT_EQ(judge_past_obstacle<3>(ball, ball, far, down_to(5.0)), Verdict::unproven);
  EXPECT_EQ(judge_past_obstacle<3>(ball, ball, far, down_to(std::nextafter(5.0, 0.0))), Verdict::violation);
  EXPECT_EQ(judge_past_obstacle<3>(ball, ball, far, down_to(5.0 + 1e-9)), Verdict::certified);
  EXPECT_EQ(judge_past_obstacle<3>(ball, ball, far, down_to(-9)), Verdict::violation)
      << "through the whole ball";
}

}  // namespace
}  // namespace bb::audit::obstacle_surface_test
