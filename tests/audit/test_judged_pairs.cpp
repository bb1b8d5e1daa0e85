// Pairs of bodies that are judged at the ends of steps alone: what happens within a step is none of their
// business, its end and its straight motion are.
#include <gtest/gtest.h>

#include "core/audit/audit.hpp"
#include "tests/audit/small_scenes.hpp"

namespace bb::audit::judged_pairs_test {
namespace {

/// Two triangles, bodies 0 and 1, of which the pair is late; with `all` each with itself too.
AuditMesh late_triangles(bool all = false) {
  AuditMesh mesh = two_triangles();
  mesh.judged.owner = {0, 0, 0, 1, 1, 1};
  mesh.judged.n_bodies = 2;
  mesh.judged.late = {{0, 1}};
  if (all) mesh.judged.late = {{0, 0}, {0, 1}, {1, 1}};
  return mesh;
}

/// The second triangle, smaller, at height z over the first, which rises to 0.6 and is at 0.27 to 0.33 there.
Positions at(double z) {
  Positions x(3, 6);
  x << -1, 1, 0, -0.1, 0.1, 0,     //
      -1, -1, 1, -0.1, -0.1, 0.1,  //
      0, 0, 0.6, z, z, z;
  return x;
}

/// On both sides of it.
Positions across() {
  Positions x = at(0);
  x(2, 3) = x(2, 4) = 0.4, x(2, 5) = 0.1;
  return x;
}

struct Step {
  std::vector<Positions> way;  // the start first
};

AuditLedger judged(const AuditMesh& mesh, const std::vector<Step>& steps, bool all_motions = false) {
  Audit audit(mesh);
  audit.check_state(steps[0].way[0], -1);
  int number = 0;
  for (const Step& step : steps) {
    audit.judge_all_motions(all_motions);
    for (std::size_t k = 1; k < step.way.size(); ++k) {
      audit.check_motion(step.way[k - 1], step.way[k], number, tolerance);
      audit.check_state(step.way[k], number);
    }
    audit.check_step_end(step.way.front(), step.way.back(), number++, tolerance);
    audit.judge_all_motions(false);
  }
  return audit.ledger();
}

TEST(JudgedPairs, WhatIsThroughWithinAStepAndBackAtItsEndIsClean) {
  const std::vector<Step> steps = {{{at(0.5), at(-0.5), across(), at(0.4)}}};
  const AuditLedger late = judged(late_triangles(), steps);
  EXPECT_TRUE(late.ok());
  EXPECT_GT(late.motion_pairs, 0) << "nothing was judged of the step";
  EXPECT_EQ(late.states, 4);
  EXPECT_EQ(late.motions, 3);
  const AuditLedger always = judged(two_triangles(), steps);
  EXPECT_GT(always.violations, 0);
  EXPECT_GT(always.crossings, 0);
}

TEST(JudgedPairs, TheStraightMotionOfAStepCounts) {
  const AuditLedger through = judged(late_triangles(), {{{at(0.5), at(0.45), at(-0.5)}}});
  EXPECT_GT(through.violations, 0);
  EXPECT_TRUE(through.penetrated());
  EXPECT_EQ(through.first_bad_step, 0);
  ASSERT_TRUE(through.first_bad);
  const AuditLedger two = judged(late_triangles(), {{{at(0.5), at(0.45)}}, {{at(0.45), at(-0.5)}}});
  EXPECT_EQ(two.first_bad_step, 1);
}

TEST(JudgedPairs, TheStateAtTheEndOfAStepCounts) {
  const AuditLedger end = judged(late_triangles(), {{{at(0.5), across()}}});
  EXPECT_EQ(end.crossings, judged(two_triangles(), {{{at(0.5), across()}}}).crossings);
  EXPECT_GT(end.crossings, 0);
}

TEST(JudgedPairs, WhereEveryMotionIsJudgedTheyAreAsAllOthers) {
  const std::vector<Step> steps = {{{at(0.5), at(-0.5), at(0.4)}}};
  EXPECT_EQ(judged(late_triangles(), steps, true).violations, judged(two_triangles(), steps).violations);
  EXPECT_EQ(judged(late_triangles(), steps).violations, 0);
}

TEST(JudgedPairs, CountsSayWhatWasCompared) {
  const std::vector<Step> still = {{{at(0.5), at(0.4)}}};
  AuditMesh mesh = late_triangles(true);
  Audit audit(mesh);
  audit.check_state(at(0.5), -1);
  const long at_start = audit.ledger().pair_queries;
  EXPECT_GT(at_start, 0) << "the start is judged whole";
  audit.check_motion(at(0.5), at(0.4), 0, tolerance);
  audit.check_state(at(0.4), 0);
  EXPECT_EQ(audit.ledger().pair_queries, at_start) << "no pair was compared within the step";
  audit.check_step_end(at(0.5), at(0.4), 0, tolerance);
  EXPECT_EQ(audit.ledger().pair_queries, judged(two_triangles(), still).pair_queries);
  EXPECT_TRUE(audit.ledger().ok());
}

TEST(JudgedPairs, OtherPairsAreJudgedInEveryMotion) {
  AuditMesh mesh = late_triangles();
  mesh.judged.late = {{0, 0}};
  EXPECT_GT(judged(mesh, {{{at(0.5), at(-0.5), at(0.4)}}}).violations, 0);
}

TEST(JudgedPairs, ObstaclesAreOwnersToo) {
  AuditMesh mesh = two_triangles();
  AuditObstacle ball;
  ball.kind = ObstacleKind::sphere;
  ball.point = Vec3d(0, 0, 1);
  ball.radius = 0.2;
  mesh.obstacles = {ball};
  mesh.judged = late_triangles().judged;
  const std::vector<Step> dips = {{{at(0.5), at(0.9), at(0.4)}}};
  EXPECT_GT(judged(mesh, dips).obstacle_violations, 0) << "this pair is judged in every motion";
  mesh.judged.late = {{1, 2}};
  const AuditLedger late = judged(mesh, dips);
  EXPECT_TRUE(late.ok());
  EXPECT_GT(late.obstacle_judged.total(), 0);
  EXPECT_GT(judged(mesh, {{{at(0.5), at(0.45), at(0.9)}}}).obstacle_violations, 0);
  EXPECT_GT(judged(mesh, {{{at(0.5), at(1.6)}}}).obstacle_violations, 0) << "through it in one step";
}

}  // namespace
}  // namespace bb::audit::judged_pairs_test
