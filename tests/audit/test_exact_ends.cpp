// Where rounding decides if nobody looks: hits at times at which a span of time ends, starts and ends beyond an obstacle by
// an ulp, and edges so long that the rounding of their ends is larger than the gap in their middle.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/audit/obstacle_motion.hpp"
#include "core/audit/obstacle_sign.hpp"

namespace bb::audit::exact_ends_test {
namespace {

Vec3d integers(std::mt19937& random, int size) {
  std::uniform_int_distribution<int> c(-size, size);
  const int x = c(random), y = c(random);
  return Vec3d(x, y, c(random));
}

/// Points at the time j eighths and their ways: both ends are integers.
template <class Pair>
PairMotion<Pair> through(const std::array<Vec3d, 4>& there, const std::array<Vec3d, 4>& way, int j) {
  PairMotion<Pair> m;
  for (std::size_t k = 0; k < 4; ++k) {
    m.x0[k] = 8 * there[k] - j * way[k];
    m.x1[k] = 8 * there[k] + (8 - j) * way[k];
  }
  return m;
}

/// At j eighths the vertex is in the middle of the triangle exactly, on its way from one side to the other, while the
/// triangle turns.
TEST(ExactEnds, AHitWhereSpansOfTimeEndIsAViolation) {
  std::mt19937 random(3);
  int violations = 0, edges = 0, turning = 0;
  for (int i = 0; i < 240; ++i) {
    const int j = i % 9;
    std::array<Vec3d, 4> there, way;
    for (Vec3d& w : way) w = integers(random, 12);
    for (std::size_t k = 1; k < 4; ++k) there[k] = 4 * integers(random, 3);
    there[0] = (there[1] + there[2] + 2 * there[3]) / 4;
    const Vec3d normal = (there[2] - there[1]).cross(there[3] - there[1]);
    const double rate = normal.dot(way[0] - (way[1] + way[2] + 2 * way[3]) / 4);
    if (normal.isZero(0) || rate == 0) continue;
    const Verdict verdict = judge(through<VertexTriangle>(there, way, j), 1e-9);
    // at either end of the motion it only touches
    EXPECT_NE(verdict, Verdict::certified) << i;
    if (j == 0 || j == 8) continue;
    EXPECT_EQ(verdict, Verdict::violation) << i;
    ++violations;
    const auto plain = judge(through<VertexTriangle>(there, {way[0], way[0], way[0], way[0]}, j), 1e-9);
    turning += plain != Verdict::violation;
    // two edges whose middles meet
    there = {4 * integers(random, 3), 4 * integers(random, 3), 4 * integers(random, 3), Vec3d::Zero()};
    there[3] = there[0] + there[1] - there[2];
    const Vec3d across = (there[1] - there[0]).cross(there[3] - there[2]);
    if (across.isZero(0) || across.dot(way[0] + way[1] - way[2] - way[3]) == 0) continue;
    EXPECT_EQ(judge(through<EdgeEdge>(there, way, j), 1e-9), Verdict::violation) << i;
    ++edges;
  }
  EXPECT_GT(violations, 120);
  EXPECT_GT(edges, 80);
  EXPECT_GT(turning, 120);
}

AuditObstacle unit(ObstacleKind kind) {
  AuditObstacle o;
  o.kind = kind, o.radius = 1, o.axis = Vec3d(2, 0, 0);
  return o;
}

/// An edge or a triangle whose middle is at the height z above the centre or the axis.
template <std::size_t N>
std::array<Vec3d, N> at_height(double z) {
  std::array<Vec3d, N> out;
  const Vec3d corners[] = {Vec3d(0.5, -2, z), Vec3d(-0.5, 2, z), Vec3d(-3, -0.5, z)};
  std::copy_n(corners, N, out.begin());
  return out;
}

template <std::size_t N>
void expect_ends(ObstacleKind kind, int& beyond, int& outside) {
  const AuditObstacle o = unit(kind);
  for (const double away : {1.0, 64.0, 4096.0}) {
    const auto far = at_height<N>(1 + away), near = at_height<N>(1 + 0x1p-44);
    EXPECT_EQ(judge_past_obstacle<N>(o, o, near, far), Verdict::certified) << N << away;
    EXPECT_EQ(judge_past_obstacle<N>(o, o, far, near), Verdict::certified) << N << away;
    ++outside;
    const auto inside = at_height<N>(1 - 0x1p-53);
    EXPECT_EQ(judge_past_obstacle<N>(o, o, inside, far), Verdict::violation) << N << " leaves by " << away;
    EXPECT_EQ(judge_past_obstacle<N>(o, o, far, inside), Verdict::violation) << N << " comes by " << away;
    EXPECT_NE(judge_past_obstacle<N>(o, o, at_height<N>(1), far), Verdict::violation) << "a touch";
    EXPECT_NE(judge_past_obstacle<N>(o, o, at_height<N>(1), far), Verdict::certified) << "a touch";
    ++beyond;
  }
}

TEST(ExactEnds, AStartOrAnEndBeyondAnObstacleByAnUlpIsAViolation) {
  int beyond = 0, outside = 0;
  for (const ObstacleKind kind : {ObstacleKind::sphere, ObstacleKind::cylinder}) {
    expect_ends<2>(kind, beyond, outside);
    expect_ends<3>(kind, beyond, outside);
  }
  EXPECT_EQ(outside, 12);
  EXPECT_EQ(beyond, 12);
}

/// Long edges and wide triangles that nearly touch a small obstacle: what is certified is free at both ends, exactly.
template <std::size_t N>
void expect_exact(std::mt19937& random, int& certified, int& hit) {
  std::uniform_real_distribution<double> c(-1, 1);
  for (int i = 0; i < 400; ++i) {
    AuditObstacle o;
    o.kind = i % 2 ? ObstacleKind::sphere : ObstacleKind::cylinder;
    o.radius = 0.01, o.axis = Vec3d(c(random), c(random), 2);
    o.point = Vec3d(c(random), c(random), c(random));
    const Vec3d any(c(random), c(random), c(random));
    const Vec3d along = o.kind == ObstacleKind::cylinder ? o.axis.normalized() : Vec3d::Zero();
    const Vec3d n = (any - along * along.dot(any)).normalized(), u = n.unitOrthogonal(), v = n.cross(u);
    const double off = (i % 4 < 2 ? 1 : -1) * std::pow(10.0, -7 - 4 * std::abs(c(random)));
    const Vec3d foot = o.point + n * (0.01 * (1 + off));
    const double length = std::pow(10.0, 1 + 2 * std::abs(c(random)));
    std::array<Vec3d, N> x;
    const Vec3d ends[] = {length * (u + 0.3 * v), -length * (u + 0.3 * v) * 0.7, length * (v - 0.2 * u)};
    for (std::size_t k = 0; k < N; ++k) x[k] = foot + ends[k];
    bool beyond = false;
    if constexpr (N == 2) beyond = obstacle_hit(o, o, x[0], x[1]);
    if constexpr (N == 3) beyond = obstacle_cuts(o, x[0], x[1], x[2]);
    const Verdict verdict = judge_past_obstacle<N>(o, o, x, x);
    EXPECT_EQ(verdict == Verdict::violation, beyond) << i << " length " << length << " off " << off;
    if (beyond) {
      EXPECT_NE(verdict, Verdict::certified);
    }
    ++(verdict == Verdict::certified ? certified : hit);
  }
}

TEST(ExactEnds, WhatIsCertifiedFarFromTheObstacleIsFreeExactly) {
  std::mt19937 random(12);
  int certified = 0, hit = 0;
  expect_exact<2>(random, certified, hit);
  expect_exact<3>(random, certified, hit);
  EXPECT_GT(certified, 100);
  EXPECT_GT(hit, 200);
}

}  // namespace
}  // namespace bb::audit::exact_ends_test
