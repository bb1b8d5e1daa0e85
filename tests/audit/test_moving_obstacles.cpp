// Obstacles that move: a motion past one is the same motion relative to it, judged as exactly; what is fixed is judged too.
#include <gtest/gtest.h>

#include <random>

#include "core/audit/obstacle_motion.hpp"
#include "core/audit/obstacle_sign.hpp"
#include "core/math/error.hpp"
#include "tests/audit/small_scenes.hpp"

namespace bb::audit::moving_obstacles_test {
namespace {

/// Multiples of 2^-10 in a box of half side `size`: sums and differences of a few are exact.
Vec3d dyadic(std::mt19937_64& rng, double size) {
  Vec3d out;
  for (int k = 0; k < 3; ++k) {
    out[k] = std::round(std::uniform_real_distribution<double>(-size, size)(rng) * 1024) / 1024;
  }
  return out;
}

template <std::size_t N>
std::array<Vec3d, N> moved(std::array<Vec3d, N> x, const Vec3d& by) {
  for (Vec3d& v : x) v += by;
  return x;
}

template <std::size_t N>
void expect_relative(ObstacleKind kind, int* verdicts) {
  std::mt19937_64 rng(17 + N);
  for (int i = 0; i < 400; ++i) {
    const AuditObstacle begin{kind, dyadic(rng, 1), Vec3d(0.25, -0.5, 1), 0.5, false};
    AuditObstacle end = begin;
    const Vec3d way = dyadic(rng, 2);
    end.point += way;
    std::array<Vec3d, N> x0, x1;
    const Vec3d middle = dyadic(rng, 1.5);
    for (std::size_t k = 0; k < N; ++k) {
      x0[k] = middle + dyadic(rng, 0.5);
      x1[k] = x0[k] + dyadic(rng, 1);
    }
    const Verdict still = judge_past_obstacle<N>(begin, begin, x0, x1);
    EXPECT_EQ(judge_past_obstacle<N>(begin, end, x0, moved(x1, way)), still);
    ++verdicts[still == Verdict::violation];
    if constexpr (N == 2) {
      EXPECT_EQ(obstacle_hit(begin, end, x0[0], Vec3d(x1[0] + way)),
                obstacle_hit(begin, begin, x0[0], x1[0]));
    }
  }
}

TEST(MovingObstacles, AreJudgedByRelativeMotion) {
  for (const ObstacleKind kind : {ObstacleKind::sphere, ObstacleKind::cylinder}) {
    int verdicts[2] = {0, 0};
    expect_relative<2>(kind, verdicts);
    expect_relative<3>(kind, verdicts);
    EXPECT_GT(verdicts[0], 50);
    EXPECT_GT(verdicts[1], 50);
  }
}

/// A ball above the sheet of sheet_and_triangle(), whose centre is vertex 7.
AuditMesh with_ball() {
  AuditMesh mesh = sheet_and_triangle();
  mesh.obstacles = {{ObstacleKind::sphere, Vec3d(0, 0, 2), Vec3d::UnitZ(), 0.5, false, 7}};
  mesh.prescribed.assign(8, 0);
  mesh.prescribed[7] = 1;
  return mesh;
}
Positions with_centre(double sheet, const Vec3d& centre) {
  Positions x(3, 8);
  x.leftCols(7) = sheet_and_triangle_at(0.1);
  x.row(2).head(7).array() += sheet;
  x.col(7) = centre;
  return x;
}

TEST(MovingObstacles, ThatPassThroughASheetThatStandsStillAreFound) {
  Audit audit(with_ball());
  const Positions above = with_centre(0, Vec3d(-0.3, 0.3, 2)), below = with_centre(0, Vec3d(-0.3, 0.3, -2));
  audit.check_state(above, 0);
  EXPECT_TRUE(audit.ledger().ok());
  audit.check_motion(above, with_centre(0, Vec3d(-0.3, 0.3, 1)), 0, tolerance);
  EXPECT_TRUE(audit.ledger().ok());
  EXPECT_GT(audit.ledger().obstacle_judged.triangles, 3);
  audit.check_motion(above, below, 1, tolerance);
  EXPECT_GT(audit.ledger().obstacle_violations, 0);
  EXPECT_EQ(audit.ledger().first_bad_step, 1);
  audit.check_state(below, 1);
  Audit states(with_ball());
  states.check_state(with_centre(0, Vec3d(-0.3, 0.3, 0.3)), 2);
  EXPECT_GT(states.ledger().obstacle_violations, 0) << "where it is now";
  EXPECT_NEAR(states.gap_of(above, 0.1).to_obstacles, 2 - 0.5 - 0.12, 0.15) << "the pose of the state counts";
}

TEST(MovingObstacles, ThatGoAlongWithASheetStayOutOfIt) {
  Audit audit(with_ball());
  audit.check_motion(with_centre(0, Vec3d(-0.3, 0.3, 1)), with_centre(5, Vec3d(-0.3, 0.3, 6)), 0, tolerance);
  EXPECT_TRUE(audit.ledger().clean());
}

TEST(MovingObstacles, MeetWhatIsFixedByTheFaultOfTheScene) {
  AuditMesh mesh = with_ball();
  mesh.prescribed.assign(8, 1);
  mesh.fixed.assign(8, 1);
  mesh.fixed[7] = 0;
  Audit audit(mesh);
  audit.check_motion(with_centre(0, Vec3d(-0.3, 0.3, 2)), with_centre(0, Vec3d(-0.3, 0.3, -2)), 0, tolerance);
  EXPECT_GT(audit.ledger().scene_faults, 0);
  EXPECT_EQ(audit.ledger().obstacle_violations, 0);
  mesh.obstacles[0].vertex = -1;
  mesh.obstacles[0].point = Vec3d(-0.3, 0.3, 0);
  Audit still(mesh);
  still.check_state(with_centre(0, Vec3d(-0.3, 0.3, 0)), 0);
  EXPECT_EQ(still.ledger().scene_faults, 0) << "both are given, and still";
}

TEST(MovingObstacles, NeedAPrescribedVertex) {
  AuditMesh mesh = with_ball();
  mesh.obstacles[0].vertex = 3;
  EXPECT_THROW(Audit{mesh}, ConfigError);
  mesh.obstacles[0].vertex = 8;
  EXPECT_THROW(Audit{mesh}, ConfigError);
}

}  // namespace
}  // namespace bb::audit::moving_obstacles_test
