// The audit at obstacles, on scenes of a few triangles: what is checked, what is named, and whose fault it is.
#include <gtest/gtest.h>

#include "core/audit/audit.hpp"
#include "tests/audit/small_scenes.hpp"

namespace bb::audit::audit_obstacles_test {
namespace {

TEST(Audit, obstacles_judge_triangles_outside_and_vertices_inside) {
  AuditMesh mesh = sheet_and_triangle();
  AuditObstacle ball{ObstacleKind::sphere, Vec3d(0, 0, -1.25), Vec3d::UnitZ(), 1.0, false};
  mesh.obstacles = {ball};
  Audit outside(mesh);
  outside.check_state(sheet_and_triangle_at(0.5), 0);
  EXPECT_TRUE(outside.ledger().ok());
  outside.check_state(sheet_and_triangle_at(-0.6), 1);
  EXPECT_EQ(outside.ledger().obstacle_violations, 1);
  EXPECT_EQ(outside.ledger().obstacle_by_vertex, 1);
  EXPECT_EQ(outside.ledger().first_bad, (PairName{PairKind::vertex_obstacle, 4, 0}));
  EXPECT_EQ(outside.ledger().obstacle_judged.triangles, 2 * 3);
  EXPECT_EQ(outside.ledger().obstacle_judged.vertices, 0);

  ball.point.setZero(), ball.radius = 1.5, ball.inside = true;
  mesh.obstacles = {ball};
  Audit inside(mesh);
  inside.check_state(sheet_and_triangle_at(0.5), 0);
  EXPECT_TRUE(inside.ledger().ok());
  inside.check_state(sheet_and_triangle_at(2.0), 1);
  EXPECT_EQ(inside.ledger().obstacle_violations, 3);
  EXPECT_EQ(inside.ledger().first_bad, (PairName{PairKind::vertex_obstacle, 4, 0}));
  EXPECT_EQ(inside.ledger().obstacle_judged.vertices, 2 * 7);
  EXPECT_EQ(inside.ledger().obstacle_judged.triangles, 0);
}

TEST(Audit, what_enters_an_obstacle_between_its_vertices_is_named_and_counted_apart) {
  AuditMesh mesh = sheet_and_triangle();
  mesh.obstacles = {{ObstacleKind::sphere, Vec3d(0.3, -0.5, -1), Vec3d::UnitZ(), 1.0, false}};
  Positions x = sheet_and_triangle_at(0.5);
  x.row(2).head<4>().setConstant(-0.01);
  const StateAudit found = audit_state(mesh, x, true);
  EXPECT_EQ(found.obstacle_violations, 1);  // the ball comes through the triangle 0 1 2 alone
  EXPECT_EQ(found.obstacle_by_vertex, 0);
  EXPECT_EQ(found.first_bad, (PairName{PairKind::triangle_obstacle, 0, 0}));
  mesh.prescribed.assign(7, 0);
  mesh.prescribed[0] = mesh.prescribed[1] = 1;
  EXPECT_EQ(audit_state(mesh, x, true).obstacle_violations, 1) << "a free corner: the solver's";
  mesh.prescribed[2] = 1;
  const StateAudit given = audit_state(mesh, x, true);
  EXPECT_EQ(given.obstacle_violations, 0);
  EXPECT_EQ(given.first_fault, (PairName{PairKind::triangle_obstacle, 0, 0}));
  x.col(0) = Vec3d(0.3, -0.5, -0.5);
  mesh.prescribed[2] = 0;
  const StateAudit driven = audit_state(mesh, x, true);  // a prescribed vertex in the ball: the scene's
  EXPECT_EQ(driven.obstacle_violations, 0);
  EXPECT_EQ(driven.first_fault, (PairName{PairKind::vertex_obstacle, 0, 0}));
}

TEST(Audit, rods_and_particles_are_judged_outside_of_obstacles_as_edges_and_vertices) {
  AuditMesh mesh;
  mesh.edges.resize(2, 1);
  mesh.edges << 0, 1;
  mesh.points = {2};
  mesh.obstacles = {{ObstacleKind::cylinder, Vec3d::Zero(), Vec3d::UnitZ(), 1.0, false}};
  Positions x(3, 3);
  x << -3, 3, 0,  //
      0.5, 0.5, 2, 0, 4, 0;
  Audit audit(mesh);
  audit.check_state(x, 0);
  EXPECT_EQ(audit.ledger().obstacle_judged.edges, 1);
  EXPECT_EQ(audit.ledger().obstacle_judged.vertices, 1);
  EXPECT_EQ(audit.ledger().obstacle_violations, 1);
  EXPECT_EQ(audit.ledger().first_bad, (PairName{PairKind::edge_obstacle, 0, 0}));
  Positions y = x;
  x.row(1).head<2>().setConstant(2.0), y.row(1).head<2>().setConstant(-2.0), y(1, 2) = 1.5;
  Audit motion(mesh);
  motion.check_motion(x, y, 0, tolerance);
  EXPECT_EQ(motion.ledger().obstacle_violations, 1) << "through the cylinder between two free states";
  EXPECT_EQ(motion.ledger().obstacle_judged.edges, 1);
  EXPECT_EQ(motion.ledger().obstacle_judged.vertices, 1);
}

TEST(Audit, a_fixed_vertex_beyond_a_plane_counts_when_something_free_hangs_on_it) {
  AuditMesh mesh = sheet_and_triangle();
  mesh.obstacles = {{ObstacleKind::plane, Vec3d(0, 0, 0.1), Vec3d::UnitZ(), 0.0, false}};
  Positions x = sheet_and_triangle_at(0.5);
  x(2, 0) = x(2, 1) = x(2, 2) = 0.3;
  x(2, 3) = 0.05;
  mesh.fixed.assign(7, 0);
  mesh.fixed[3] = 1;
  mesh.prescribed = mesh.fixed;
  EXPECT_EQ(audit_state(mesh, x, true).first_fault, (PairName{PairKind::vertex_obstacle, 3, 0}));
  for (const int v : {0, 2}) mesh.fixed[static_cast<std::size_t>(v)] = 1;
  mesh.prescribed = mesh.fixed;
  EXPECT_EQ(audit_state(mesh, x, true).scene_faults, 0) << "wholly fixed: both are given";
}

TEST(Audit, obstacle_is_judged_along_the_motion) {
  AuditMesh mesh = sheet_and_triangle();
  mesh.obstacles = {{ObstacleKind::sphere, Vec3d(0.4, -0.4, 3.0), Vec3d::UnitZ(), 0.5, false}};
  const MotionAudit found =
      audit_motion(mesh, sheet_and_triangle_at(0.5), sheet_and_triangle_at(6.0), tolerance);
  EXPECT_EQ(found.obstacle_violations, 1);
  EXPECT_EQ(found.violations, 0);
}

}  // namespace
}  // namespace bb::audit::audit_obstacles_test
