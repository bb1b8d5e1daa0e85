// What the pass `audit` writes of obstacles: a triangle over a ball with its vertices outside is a penetration, gaps are
// those of the whole surface, and every kind of primitive is counted.
#include "experiments/run/audit_watch.hpp"

#include <gtest/gtest.h>

#include "experiments/config/parse.hpp"

namespace bb::audit_watch_test {
namespace {

/// A sheet of two triangles, 1 m wide, above a ball of radius 0.1 m whose top is at z = 0 and off the diagonal.
Scene sheet_over_ball(const std::string& thickness = "0") {
  return build_scene(parse_config(
      R"({"schema": "barrierbench.config/1", "formulation": {"name": "log", "d_hat_m": 0.005}, "time": {"dt_s": 0.01, "steps": 2},
    "scene": {"name": "bodies",
      "bodies": [{"name": "sheet", "mesh": {"generator": "grid", "n_x": 2, "n_y": 2, "size_x_m": 1, "size_y_m": 1},
                  "transform": {"translate_m": [0, 0, 0.011]}, "limited": false, "offset_m": )" +
          thickness + R"(,
                  "material": {"model": "corotational", "youngs_N_per_m": 250, "poisson": 0.24, "density_kg_per_m2": 0.15}}],
      "obstacles": [{"name": "ball", "kind": "sphere", "point_m": [0.2, -0.2, -0.1], "radius_m": 0.1}]}})",
      "test"));
}

StepRecord converged() {
  StepRecord step;
  step.status = StepStatus::converged;
  return step;
}

/// A motion by z of the whole sheet, as a step of its own.
void fall(AuditWatch& watch, Positions& x, double z, int step) {
  const Positions before = x;
  x.row(2).array() += z;
  watch.on_motion(before, x, step);
  StepRecord record = converged();
  record.step = step;
  watch.on_step(x, record);
}

TEST(AuditWatch, AnOverlapWithinWhatIsPromisedIsOkAndHasADepth) {
  const Scene scene = sheet_over_ball();
  for (const double promised : {1e-6, 0.0}) {
    AuditRecord record;
    AuditWatch watch(scene, 0.01, 0.1, record, promised);
    Positions x = scene.x0;
    fall(watch, x, -0.011 - 5e-7, 0);
    const Verdict within = watch.verdict();
    if (promised == 0) {
      EXPECT_EQ(within.outcome, Outcome::penetration) << within.detail;
      continue;
    }
    EXPECT_EQ(within.outcome, Outcome::ok) << within.detail;
    EXPECT_NE(within.detail.find("5e-07 m"), std::string::npos) << within.detail;
    EXPECT_NE(within.detail.find("first in step 0"), std::string::npos) << within.detail;
    EXPECT_EQ(record.overlaps, 1);  // the triangle over the top
    EXPECT_NEAR(record.overlap_max_m.value, 5e-7, 1e-12);
    EXPECT_EQ(record.violations, 0);
    EXPECT_GT(record.judged, 0);
    fall(watch, x, -2e-6, 1);
    EXPECT_EQ(watch.verdict().outcome, Outcome::penetration) << watch.verdict().detail;
    EXPECT_EQ(record.obstacle_violations, 1);
  }
}

TEST(AuditWatch, ARunThatFreesItselfReportsHowManyCrossingsThereWereAndInWhichStepNoneWasLeft) {
  const Scene scene = sheet_over_ball();
  AuditRecord record;
  AuditWatch watch(scene, 0.01, 0.1, record);
  Positions x = scene.x0;
  fall(watch, x, -0.02, 0);
  EXPECT_GT(record.step_end_crossings_max, 0);
  EXPECT_EQ(record.step_end_crossings_last, record.step_end_crossings_max);
  EXPECT_EQ(record.recovered_step, -1);
  EXPECT_NE(watch.verdict().detail.find("steps ended with at most"), std::string::npos);
  fall(watch, x, 0.02, 1);
  fall(watch, x, 0.001, 2);
  EXPECT_GT(record.step_end_crossings_max, 0);
  EXPECT_EQ(record.step_end_crossings_last, 0);
  EXPECT_EQ(record.recovered_step, 1);
  EXPECT_EQ(watch.verdict().outcome, Outcome::penetration)
      << "what passed through something was no clean run";
  EXPECT_NE(watch.verdict().detail.find("recovery in step 1"), std::string::npos) << watch.verdict().detail;
}

TEST(AuditWatch, CrossingsOfAnAttemptThatIsDoneAgainAreNotThoseOfTheEndOfTheStep) {
  const Scene scene = sheet_over_ball();
  AuditRecord record;
  AuditWatch watch(scene, 0.01, 0.1, record);
  Positions deep = scene.x0;
  deep.row(2).array() -= 0.02;
  watch.on_motion(scene.x0, deep, 0);
  EXPECT_NE(watch.verdict().outcome, Outcome::ok) << "the attempt crosses nothing";
  watch.on_retry();
  StepRecord step = converged();
  watch.on_step(scene.x0, step);  // nothing moves in the second attempt
  EXPECT_EQ(record.step_end_crossings_max, 0);
  EXPECT_EQ(record.step_end_crossings_last, 0);
  EXPECT_EQ(watch.verdict().outcome, Outcome::ok) << watch.verdict().detail;
}

TEST(AuditWatch, AnOverlapWithinAStepIsNoneAtItsEndAndAWayThroughTheBallIsStillAPenetration) {
  const Scene scene = sheet_over_ball();
  AuditRecord record;
  AuditWatch watch(scene, 0.01, 0.1, record, 1e-6);
  Positions x = scene.x0, deep = x, end = x;
  deep.row(2).array() -= 0.02;
  end.row(2).array() -= 0.005;
  watch.on_motion(x, deep, 0);
  watch.on_motion(deep, end, 0);
  StepRecord step = converged();
  watch.on_step(end, step);
  EXPECT_EQ(watch.verdict().outcome, Outcome::ok) << watch.verdict().detail;
  fall(watch, end, -0.3, 1);  // out again below, in one step
  EXPECT_EQ(watch.verdict().outcome, Outcome::penetration) << watch.verdict().detail;
}

/// Both ends of a step are outside, and the way between them cuts a corner: it goes round.
TEST(AuditWatch, AWayThatCutsACornerRoundABallIsCountedAndNoFault) {
  const Scene scene = sheet_over_ball();
  AuditRecord record;
  AuditWatch watch(scene, 0.01, 0.1, record, 1e-6, true);
  Positions x = scene.x0;
  const auto beside = [&](double along, double above) {
    Positions to = scene.x0;
    to.colwise() += Vec3d(0.2, -0.2, -0.1) + Vec3d(along, 0, above) - to.col(0).eval();
    return to;
  };
  Positions first = beside(-0.05, 0.09),
            last = beside(0.05, 0.09);  // 0.103 m from the centre, 0.09 m between
  StepRecord step = converged();
  watch.on_motion(x, first, 0);
  watch.on_step(first, step);
  EXPECT_EQ(record.corners_cut, 0);
  watch.on_motion(first, last, 1);
  watch.on_step(last, step);
  EXPECT_EQ(watch.verdict().outcome, Outcome::ok) << watch.verdict().detail;
  EXPECT_EQ(record.corners_cut, 1);
  EXPECT_EQ(record.promised_m.value, 1e-6);
}

/// With the contact model points the same state is no failure, and the record reports how deep the surface is.
TEST(AuditWatch, OfPointsJudgesVerticesAndSaysHowDeepTheSurfaceIs) {
  const Scene scene = sheet_over_ball();
  for (const double promised : {0.0, 1e-6}) {
    AuditRecord record;
    AuditWatch watch(scene, 0.01, 0.1, record, promised, true);
    EXPECT_EQ(record.obstacles_judge, "points");
    Positions x = scene.x0;
    fall(watch, x, -0.055, 0);  // all four vertices pass beside the ball
    EXPECT_EQ(watch.verdict().outcome, Outcome::ok) << watch.verdict().detail;
    EXPECT_NE(watch.verdict().detail.find("points only"), std::string::npos) << watch.verdict().detail;
    EXPECT_NE(watch.verdict().detail.find("0.044 m deep"), std::string::npos) << watch.verdict().detail;
    EXPECT_NEAR(record.surface_gap_obstacles_m.value, -0.044, 1e-12);
    EXPECT_GT(record.obstacle_vertices, 0);
    EXPECT_EQ(record.obstacle_triangles, 0);
    Positions in = x;
    in.col(0) = Vec3d(0.2, -0.2, -0.1);  // a vertex in the centre
    StepRecord step = converged();
    watch.on_motion(x, in, 1);
    watch.on_step(in, step);
    EXPECT_EQ(watch.verdict().outcome, Outcome::penetration) << watch.verdict().detail;
  }
}

TEST(AuditWatch, ASheetThroughABallBetweenItsVerticesIsAPenetration) {
  const Scene scene = sheet_over_ball();
  AuditRecord record;
  AuditWatch watch(scene, 0.01, 0.1, record);
  Positions x = scene.x0;
  x.row(2).array() -= 0.005;
  watch.on_motion(scene.x0, x, 0);
  StepRecord step = converged();
  watch.on_step(x, step);
  EXPECT_EQ(watch.verdict().outcome, Outcome::ok) << watch.verdict().detail;
  EXPECT_NEAR(step.surface_gap_obstacles_m.value, 0.006, 1e-12);
  EXPECT_EQ(record.obstacle_triangles, 2 * 2 + 2);  // two states and a motion
  EXPECT_EQ(record.obstacle_vertices, 0);
  EXPECT_EQ(record.obstacle_edges, 0);
  EXPECT_EQ(record.obstacle_queries, record.obstacle_triangles);

  Positions through = x;
  through.row(2).array() -= 0.05;  // all four vertices pass beside the ball
  watch.on_motion(x, through, 1);
  step = converged();
  watch.on_step(through, step);
  EXPECT_EQ(watch.verdict().outcome, Outcome::penetration);
  EXPECT_NE(watch.verdict().detail.find("triangle sheet["), std::string::npos) << watch.verdict().detail;
  EXPECT_NE(watch.verdict().detail.find("enters obstacle ball"), std::string::npos) << watch.verdict().detail;
  EXPECT_EQ(step.violations, 2);  // the triangle on the way, and where it came to
  EXPECT_NEAR(step.surface_gap_obstacles_m.value, -0.044, 1e-12);
  EXPECT_NEAR(record.surface_gap_obstacles_m.value, -0.044, 1e-12);
  EXPECT_EQ(record.surface_gaps, 2);
}

TEST(AuditWatch, GapsHaveTheirThicknessTakenOffAndOnlyConvergedEndsCount) {
  const Scene scene = sheet_over_ball("0.002");
  AuditRecord record;
  AuditWatch watch(scene, 0.01, 0.1, record);
  StepRecord step = converged();
  step.status = StepStatus::iteration_cap;
  watch.on_step(scene.x0, step);
  EXPECT_STREQ(step.surface_gap_obstacles_m.status, "not_converged");
  EXPECT_EQ(record.surface_gaps, 0);
  step = converged();
  watch.on_step(scene.x0, step);
  EXPECT_NEAR(step.surface_gap_obstacles_m.value, 0.011 - 0.002, 1e-12);
  EXPECT_STREQ(step.surface_gap_between_m.status, "none_within_d_hat");
}

/// An attempt at a step that failed: the next one starts where the step did, and what was found on the way of the first
/// is no part of the run.
TEST(AuditWatch, AfterAFailedAttemptTheMotionStartsWhereTheStepDid) {
  const Scene scene = sheet_over_ball();
  AuditRecord record;
  AuditWatch watch(scene, 0.01, 0.1, record);
  const auto lower = [&](double by) {
    Positions x = scene.x0;
    x.row(2).array() -= by;
    return x;
  };
  StepRecord step = converged();
  watch.on_motion(scene.x0, lower(0.001), 0);
  watch.on_step(lower(0.001), step);
  watch.on_motion(lower(0.001), lower(0.05), 1);  // through the ball, and given up
  watch.on_retry();
  watch.on_motion(lower(0.001), lower(0.002), 1);
  watch.on_motion(lower(0.002), lower(0.003), 1);
  step = converged();
  watch.on_step(lower(0.003), step);
  EXPECT_EQ(watch.verdict().outcome, Outcome::ok) << watch.verdict().detail;
  EXPECT_EQ(step.violations, 0);
  EXPECT_EQ(record.motions, 3);
  EXPECT_EQ(record.states, 4);

  // from the end of the attempt that failed, where no motion of the run led to
  watch.on_motion(lower(0.003), lower(0.004), 2);
  watch.on_retry();
  watch.on_motion(lower(0.004), lower(0.005), 2);
  EXPECT_EQ(watch.verdict().outcome, Outcome::unproven);
  EXPECT_NE(watch.verdict().detail.find("no judged motion"), std::string::npos) << watch.verdict().detail;
}

/// Of a pair that a step is proven for when it is over, what happens within the step counts only where the
/// step is done again.
TEST(AuditWatch, OfAuditedPairsTheEndOfAStepCountsAndAllOfOneThatIsDoneAgain) {
  Scene scene = sheet_over_ball();
  scene.collisions.pairs = {{0, 1, CollisionKind::audited, "as given"}};
  Positions through = scene.x0;
  through.row(2).array() -= 0.05;
  for (const bool redone : {false, true}) {
    Positions back = scene.x0;
    back.row(2).array() -= 0.001;
    AuditRecord record;
    AuditWatch watch(scene, 0.01, 0.1, record);
    StepRecord step = converged();
    if (redone) {
      watch.on_motion(scene.x0, through, 0);
      watch.on_redo();
    }
    watch.on_motion(scene.x0, through, 0);
    watch.on_motion(through, back, 0);
    watch.on_step(back, step);
    EXPECT_EQ(watch.verdict().outcome, redone ? Outcome::penetration : Outcome::ok) << watch.verdict().detail;
    EXPECT_EQ(step.violations > 0, redone);
    EXPECT_EQ(record.motions, 2);
    EXPECT_GT(record.obstacle_triangles, 0);
    fall(watch, back, -0.3, 1);
    EXPECT_EQ(watch.verdict().outcome, Outcome::penetration) << "the next step is judged at its end again";
  }
}

/// The first attempt of the first step: the start is the state that it goes back to.
TEST(AuditWatch, AFailedFirstAttemptGoesBackToTheStart) {
  const Scene scene = sheet_over_ball();
  AuditRecord record;
  AuditWatch watch(scene, 0.01, 0.1, record);
  Positions x = scene.x0;
  x.row(2).array() -= 0.05;
  watch.on_motion(scene.x0, x, 0);
  watch.on_retry();
  StepRecord step = converged();
  watch.on_step(scene.x0, step);
  EXPECT_EQ(watch.verdict().outcome, Outcome::ok) << watch.verdict().detail;
  EXPECT_EQ(record.motions, 0);
  EXPECT_EQ(record.states, 1);
}

}  // namespace
}  // namespace bb::audit_watch_test
