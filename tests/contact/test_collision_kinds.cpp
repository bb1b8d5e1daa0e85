// What contact does with a pair of bodies: rows, states that are tested, a bound of motions, or nothing.
#include <gtest/gtest.h>

#include <cmath>

#include "core/contact/intersection.hpp"
#include "tests/contact/contact_scenes.hpp"

namespace bb::collision_kinds_test {
namespace {

using namespace test;

/// A sheet of 4 x 4 cells and a small triangle (vertices 25 to 27) across its plane at height z, pointing down.
Scene triangle_over_sheet(double z, CollisionKind kind) {
  Scene scene;
  const auto [vertices, triangles] = grid(4, 4, 1.0);
  add_body(scene, "sheet", vertices, triangles, 0.1);
  const Vec3d centre(1.7, 1.6, z);
  add_body(scene, "dart", {centre, centre + Vec3d(0.05, 0, 0.3), centre + Vec3d(-0.05, 0.02, 0.3)},
           {{0, 1, 2}}, 0.1);
  scene.collisions.pairs = {{0, 1, kind, "as given"}};
  return scene;
}

Positions dart_moved(const Scene& scene, double dz) {
  Positions x = scene.x0;
  x.rightCols(3).row(2).array() += dz;
  return x;
}

/// What contact reports of a motion of the dart by dz and of the state at its end.
struct Answer {
  std::size_t rows_at_start;
  double bound;
  double gap_at_end;
};
Answer ask(const Scene& scene, double dz) {
  ContactSystem contacts(scene, {});
  Answer out{};
  const Rows rows = rows_at(contacts, scene.x0);
  out.rows_at_start = rows.table.size() + rows.mollified.size();
  const Positions x1 = dart_moved(scene, dz);
  contacts.update_candidates(scene.x0, x1);
  out.bound = contacts.step_bound(scene.x0, x1).alpha;
  ContactTable table;
  MollifiedTable mollified;
  out.gap_at_end = contacts.find_rows(x1, table, mollified);
  return out;
}

constexpr double near = 0.05, halfway = -0.2, beyond = -1;  // m; the dart is 0.3 long

TEST(CollisionKinds, CcdHasRowsAndABound) {
  const Answer through = ask(triangle_over_sheet(near, CollisionKind::ccd), beyond);
  EXPECT_GT(through.rows_at_start, 0u);
  EXPECT_LT(through.bound, 0.1);
}

TEST(CollisionKinds, ProximityHasTheSameRowsAndNothingElse) {
  const Scene scene = triangle_over_sheet(near, CollisionKind::proximity);
  EXPECT_EQ(ask(scene, beyond).rows_at_start,
            ask(triangle_over_sheet(near, CollisionKind::ccd), beyond).rows_at_start);
  EXPECT_GT(ask(scene, beyond).rows_at_start, 0u);
  EXPECT_EQ(ask(scene, beyond).bound, 1);
  EXPECT_EQ(ask(scene, halfway).bound, 1);
  EXPECT_GT(ask(scene, halfway).gap_at_end, 0);
}

TEST(CollisionKinds, AuditedHasNoBoundUntilItIsAskedForAndAProofOfAStep) {
  const Scene scene = triangle_over_sheet(near, CollisionKind::audited);
  const Answer ccd = ask(triangle_over_sheet(near, CollisionKind::ccd), beyond);
  EXPECT_EQ(ask(scene, beyond).rows_at_start, ccd.rows_at_start);
  EXPECT_EQ(ask(scene, beyond).bound, 1);
  EXPECT_GT(ask(scene, halfway).gap_at_end, 0);
  ContactSystem contacts(scene, {});
  const Positions x1 = dart_moved(scene, beyond);
  contacts.update_candidates(scene.x0, x1);
  contacts.bound_audited(true);
  EXPECT_EQ(contacts.step_bound(scene.x0, x1).alpha, ccd.bound);
  contacts.bound_audited(false);
  EXPECT_EQ(contacts.step_bound(scene.x0, x1).alpha, 1);
  const StepBound proof = contacts.prove_step(scene.x0, x1);
  EXPECT_EQ(proof.alpha, ccd.bound);
  EXPECT_GT(proof.queries, 0);
  EXPECT_LT(contacts.prove_step(scene.x0, dart_moved(scene, halfway)).alpha, 1);
  EXPECT_EQ(contacts.prove_step(scene.x0, dart_moved(scene, -near / 2)).alpha, 1);
  Positions broken = x1;
  broken(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(contacts.prove_step(scene.x0, broken).alpha, 0);
}

TEST(CollisionKinds, AProofOfAStepIsOfAuditedPairsAloneAndLeavesTheCandidates) {
  const Scene scene = triangle_over_sheet(near, CollisionKind::ccd);
  ContactSystem contacts(scene, {});
  contacts.update_candidates(scene.x0, scene.x0);
  const auto before = contacts.candidate_counts();
  const StepBound proof = contacts.prove_step(scene.x0, dart_moved(scene, beyond));
  EXPECT_EQ(proof.alpha, 1);
  EXPECT_EQ(proof.queries, 0);
  EXPECT_GT(before.point_triangle, 0U);
  EXPECT_EQ(contacts.candidate_counts().point_triangle, before.point_triangle);
}

TEST(CollisionKinds, StaticRefusesStatesThatIntersectAndNoMotion) {
  const Scene scene = triangle_over_sheet(near, CollisionKind::static_test);
  EXPECT_GT(ask(scene, beyond).rows_at_start, 0u);
  EXPECT_EQ(ask(scene, halfway).bound, 1);
  EXPECT_EQ(ask(scene, halfway).gap_at_end, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(ask(scene, beyond).bound, 1);
  EXPECT_GT(ask(scene, beyond).gap_at_end, 0) << "it went through as a whole: the audit's to find";
}

TEST(CollisionKinds, OffHasNoCandidates) {
  Scene scene = triangle_over_sheet(near, CollisionKind::off);
  scene.collisions.pairs.insert(scene.collisions.pairs.begin(), {0, 0, CollisionKind::off, "as given"});
  const Answer through = ask(scene, halfway);
  EXPECT_EQ(through.rows_at_start, 0u);
  EXPECT_EQ(through.bound, 1);
  EXPECT_EQ(through.gap_at_end, std::numeric_limits<double>::infinity());
  ContactSystem contacts(scene, {});
  contacts.update_candidates(scene.x0, dart_moved(scene, beyond));
  const auto counts = contacts.candidate_counts();
  EXPECT_EQ(counts.point_triangle + counts.edge_edge, 0u);
}

TEST(CollisionKinds, ToTheBoundTheyAreTheSame) {
  for (const CollisionKind kind : {CollisionKind::ccd, CollisionKind::proximity}) {
    const Scene scene = triangle_over_sheet(near, kind);
    ContactSystem contacts(scene, {});
    const Rows rows = rows_at(contacts, scene.x0);
    ASSERT_GT(rows.table.size(), 0u);
    const Positions x1 = dart_moved(scene, beyond);
    contacts.update_candidates_to_bound(scene.x0, x1);
    EXPECT_EQ(contacts.step_bound(scene.x0, x1).alpha, ask(scene, beyond).bound);
  }
}

TEST(CollisionKinds, DifferentGroupsAreOffUnlessAPairSaysOtherwise) {
  Scene scene = triangle_over_sheet(near, CollisionKind::ccd);
  scene.collisions.pairs.clear();
  scene.collisions.group = {0, 1};
  EXPECT_EQ(ask(scene, beyond).rows_at_start, 0u);
  for (const std::vector<int>& meet : {std::vector{0, 0}, {-1, 1}, {-1, -1}}) {
    scene.collisions.group = meet;
    EXPECT_GT(ask(scene, beyond).rows_at_start, 0u) << meet[0] << " " << meet[1];
    EXPECT_LT(ask(scene, beyond).bound, 1);
  }
  scene.collisions.group = {0, 1};
  scene.collisions.pairs = {{0, 1, CollisionKind::proximity, "as given"}};
  EXPECT_GT(ask(scene, beyond).rows_at_start, 0u);
}

TEST(CollisionKinds, OfABodyWithItselfLeaveOtherPairs) {
  Scene scene = triangle_over_sheet(near, CollisionKind::ccd);
  scene.collisions.pairs = {{0, 0, CollisionKind::off, "as given"}};
  Positions folded = scene.x0;
  folded.col(24) = folded.col(0) + Vec3d(0.3, 0.2, 0.01);  // a corner over the opposite one
  ContactSystem contacts(scene, {});
  Rows rows = rows_at(contacts, folded);
  const auto of_sheet_alone = [](const ContactTable& table) {
    int n = 0;
    for (std::size_t r = 0; r < table.size(); ++r)
      n += table.stencil[4 * r] < 25 && table.stencil[4 * r + 1] < 25;
    return n;
  };
  EXPECT_EQ(of_sheet_alone(rows.table), 0);
  EXPECT_GT(rows.table.size(), 0u) << "sheet and dart";
  scene.collisions.pairs.clear();
  ContactSystem all(scene, {});
  rows = rows_at(all, folded);
  EXPECT_GT(of_sheet_alone(rows.table), 0);
}

TEST(CollisionKinds, OfObstacles) {
  for (const CollisionKind kind : {CollisionKind::ccd, CollisionKind::proximity, CollisionKind::off}) {
    Scene scene = point_over_grid(Vec3d(2, 2, 3), 0.1);
    Obstacle floor;
    floor.name = "floor";
    floor.point = Vec3d(0, 0, -0.05);
    Obstacle ball;
    ball.name = "ball";
    ball.kind = ObstacleKind::sphere;
    ball.point = Vec3d(1.1, 1.2, 1.05);
    ball.radius = 1;
    scene.obstacles = {floor, ball};
    scene.collisions.pairs = {{0, 2, kind, ""}, {0, 3, kind, ""}};  // the bodies are 0 and 1
    ContactSystem contacts(scene, {});
    const Rows rows = rows_at(contacts, scene.x0);
    Positions x1 = scene.x0;
    x1.row(2).array() -= 0.2;
    contacts.update_candidates(scene.x0, x1);
    const double bound = contacts.step_bound(scene.x0, x1).alpha;
    EXPECT_EQ(rows.table.size() > 0, kind != CollisionKind::off);
    EXPECT_EQ(bound < 1, kind == CollisionKind::ccd);
    ContactTable table;
    MollifiedTable mollified;
    EXPECT_EQ(contacts.find_rows(x1, table, mollified) > 0, kind == CollisionKind::off)
        << "an obstacle has an inside";
  }
}

TEST(CollisionKinds, APlanWithoutAPairHasNoBroadPhase) {
  Scene scene = triangle_over_sheet(near, CollisionKind::off);
  EXPECT_TRUE(plan_contact(scene).broad_phase.needed) << "the sheet may meet itself";
  scene.collisions.pairs = {
      {0, 0, CollisionKind::off, ""}, {0, 1, CollisionKind::off, ""}, {1, 1, CollisionKind::off, ""}};
  const ContactPlan plan = plan_contact(scene);
  EXPECT_FALSE(plan.any());
  EXPECT_TRUE(plan.collisions.needed);
  EXPECT_EQ(plan.collisions.reason, "pairs of bodies: 3 off");
  scene.collisions = {};
  EXPECT_FALSE(plan_contact(scene).collisions.needed);
}

/// By the point where the line meets the plane, in long double; nothing where that is within rounding of a border.
std::optional<bool> pierces_by_solving(const Vec3d& p, const Vec3d& q, const Mat3d& t) {
  using Wide = Eigen::Matrix<long double, 3, 1>;
  Eigen::Matrix<long double, 3, 3> a;
  const Wide o = t.col(0).cast<long double>();
  a.col(0) = t.col(1).cast<long double>() - o;
  a.col(1) = t.col(2).cast<long double>() - o;
  a.col(2) = (p - q).cast<long double>();
  if (std::abs(a.determinant()) < 1e-9L) return std::nullopt;
  const Wide s = a.inverse() * (p.cast<long double>() - o);
  const long double inside = std::min({s[0], s[1], 1 - s[0] - s[1], s[2], 1 - s[2]});
  if (std::abs(inside) < 1e-9L) return std::nullopt;
  return inside > 0;
}

TEST(CollisionKinds, AnEdgePiercesATriangleWhereTheLineMeetsIt) {
  std::mt19937_64 rng(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  int yes = 0, no = 0;
  for (int k = 0; k < 4000; ++k) {
    const Mat3d t = Mat3d::NullaryExpr([&] { return unit(rng); });
    const Vec3d p(unit(rng), unit(rng), unit(rng)), q(unit(rng), unit(rng), unit(rng));
    const std::optional<bool> expected = pierces_by_solving(p, q, t);
    if (!expected) continue;
    ASSERT_EQ(pierces(p, q, t.col(0), t.col(1), t.col(2)), *expected) << k;
    ++(*expected ? yes : no);
  }
  EXPECT_GT(yes, 100);
  EXPECT_GT(no, 1000);
}

}  // namespace
}  // namespace bb::collision_kinds_test
