// Ends of steps at a cusp of an element's energy: they are counted, named and no minimum; `escape` leaves them, and so does a start that
// is a hair off.
#include <gtest/gtest.h>

#include "tests/newton/small_scenes.hpp"

namespace bb::cusp_test {
namespace {

constexpr double dt = 0.01;

Scene sheets(double apart, bool stitched) {
  SceneBuilder builder("sheets", false, Vec3d::Zero(), "test");
  for (const char* name : {"A", "B"}) {
    BodySpec spec = test::cloth_spec(2, 0, 0.001);
    spec.name = name;
    if (spec.name == "B") spec.mesh.vertices.row(2).array() += apart;
    builder.add_body(spec);
  }
  Scene scene = builder.finish();
  scene.collisions.pairs = {{0, 1, CollisionKind::off, "as the test wants"}};
  if (stitched) {
    for (int v = 0; v < 4; ++v) {
      scene.stitches.pairs.push_back({v, v + 4});
      scene.stitches.rest_length.push_back(0.1);
      scene.stitches.stiffness.push_back(100);
    }
  }
  return scene;
}

/// A rod of two segments whose ends lie on each other (back = -1), or that is straight (1); `off`: how far its last vertex is beside it.
Scene rod(double back, double off, bool rests_straight) {
  SceneBuilder builder("rod", false, Vec3d::Zero(), "test");
  BodySpec spec;
  spec.name = "rod";
  spec.mesh = rod_mesh(2, Vec3d(0, 0, 0), Vec3d(1, 0, 0));
  spec.material.line_density = 0.1;
  spec.material.springs = 10;
  spec.material.rod_bending = 0.01;
  spec.d_hat = 0.001;
  if (!rests_straight) spec.mesh.vertices.col(2) = Vec3d(0.5, 0.5, 0);
  builder.add_body(spec);
  Scene scene = builder.finish();
  scene.x0.col(2) = Vec3d(0.5 + 0.5 * back, off, 0);
  scene.collisions.pairs = {{0, 0, CollisionKind::off, "its halves lie on each other"}};
  return scene;
}

StepReport step_of(const Scene& scene, SaddleRule rule, Positions* end = nullptr, int steps = 1) {
  Method method = test::fixed_method("log", 1);
  method.step_solver.saddle = rule;
  Simulation simulation(scene, method, dt, steps);
  StepObserver nobody;
  StepReport report;
  for (int i = 0; i < steps; ++i) report = simulation.step(nobody);
  EXPECT_EQ(report.status, StepStatus::converged) << report.detail;
  if (end) *end = simulation.history().x;
  return report;
}

TEST(Cusps, coincident_ends_of_stitches_are_counted_and_are_no_minimum) {
  const StepReport report = step_of(sheets(0, true), SaddleRule::report);
  EXPECT_EQ(report.end_proof, EndProof::cusp);
  EXPECT_EQ(report.cusps, 4);
  EXPECT_EQ(report.first_cusp, "element 0 of term stitch (A[0], B[0])");
  const StepReport without = step_of(sheets(0, false), SaddleRule::report);
  EXPECT_EQ(without.end_proof, EndProof::clamped);  // as the Hessians of this method are
  EXPECT_EQ(without.cusps, 0);
  EXPECT_TRUE(without.first_cusp.empty());
}

TEST(Cusps, escape_leaves_coincident_stitches_and_they_open_to_their_length) {
  Positions end;
  const StepReport report = step_of(sheets(0, true), SaddleRule::escape, &end, 400);
  EXPECT_NE(report.end_proof, EndProof::cusp);
  EXPECT_EQ(report.cusps, 0);
  for (int v = 0; v < 4; ++v) EXPECT_NEAR((end.col(v) - end.col(v + 4)).norm(), 0.1, 0.01);
}

TEST(Cusps, a_hair_apart_there_is_none) {
  Positions end;
  const StepReport report = step_of(sheets(1e-9, true), SaddleRule::report, &end, 400);
  EXPECT_EQ(report.cusps, 0);
  for (int v = 0; v < 4; ++v) EXPECT_NEAR((end.col(v) - end.col(v + 4)).norm(), 0.1, 0.01);
}

TEST(Cusps, a_rod_that_is_folded_back_is_at_one) {
  const StepReport folded = step_of(rod(-1, 0, true), SaddleRule::report);
  EXPECT_EQ(folded.end_proof, EndProof::cusp);
  EXPECT_EQ(folded.cusps, 1);
  EXPECT_EQ(folded.first_cusp, "element 0 of term rods (rod[0], rod[1], rod[2])");
  EXPECT_EQ(step_of(rod(1, 0, true), SaddleRule::report).end_proof, EndProof::clamped);
  EXPECT_EQ(step_of(rod(1, 0, false), SaddleRule::report).end_proof,
            EndProof::cusp);  // straight, though curved at rest
  for (const SaddleRule rule : {SaddleRule::report, SaddleRule::escape}) {
    Positions end;
    const double off = rule == SaddleRule::report ? 1e-9 : 0;
    const StepReport left = step_of(rod(-1, off, true), rule, &end, 300);
    EXPECT_EQ(left.cusps, 0);
    EXPECT_GT((end.col(2) - end.col(0)).norm(), 0.5) << "it unfolds";
  }
}

/// The proof of a step that is not looked at says so, as before.
TEST(Cusps, nobody_looks_under_ignore) {
  const StepReport report = step_of(sheets(0, true), SaddleRule::ignore);
  EXPECT_EQ(report.end_proof, EndProof::not_checked);
  EXPECT_EQ(report.cusps, 0);
}

}  // namespace
}  // namespace bb::cusp_test
