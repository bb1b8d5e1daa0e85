// The audit as Newton uses it, on scenes of a few triangles: states, motions, planar scenes, ledger.
#include "core/audit/audit.hpp"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <Eigen/Geometry>
#include <limits>
#include <random>

#include "core/math/error.hpp"
#include "tests/audit/small_scenes.hpp"

namespace bb::audit::audit_test {
namespace {

TEST(Audit, clean_scene_is_ok_and_was_judged) {
  Audit audit(sheet_and_triangle());
  audit.check_state(sheet_and_triangle_at(0.5), 0);
  audit.check_motion(sheet_and_triangle_at(0.5), sheet_and_triangle_at(0.02), 1, tolerance);
  audit.check_state(sheet_and_triangle_at(0.02), 1);
  EXPECT_TRUE(audit.ledger().ok());
  EXPECT_EQ(audit.ledger().states, 2);
  EXPECT_EQ(audit.ledger().motions, 1);
  EXPECT_GT(audit.ledger().motion_pairs, 0);
  EXPECT_EQ(audit.ledger().first_bad_step, -1);
}

TEST(Audit, triangle_that_jumps_through_a_sheet_is_a_violation_of_the_motion_only) {
  Audit audit(sheet_and_triangle());
  audit.check_state(sheet_and_triangle_at(0.5), 0);
  audit.check_state(sheet_and_triangle_at(-0.5), 7);
  EXPECT_TRUE(audit.ledger().ok()) << "both ends are free of crossings";
  audit.check_motion(sheet_and_triangle_at(0.5), sheet_and_triangle_at(-0.5), 7, tolerance);
  EXPECT_FALSE(audit.ledger().ok());
  EXPECT_EQ(audit.ledger().violations, 3);
  EXPECT_EQ(audit.ledger().unproven, 0);
  EXPECT_EQ(audit.ledger().first_bad_step, 7);
  EXPECT_EQ(audit.ledger().first_bad, (PairName{PairKind::vertex_triangle, 4, 0}));
}

TEST(Audit, crossing_state_names_its_first_pair) {
  Audit audit(sheet_and_triangle());
  audit.check_state(sheet_and_triangle_at(0.0), 3);
  // the edge opposite to the vertex in the sheet, and the two edges that pass through it at that vertex
  EXPECT_EQ(audit.ledger().crossings, 3);
  EXPECT_EQ(audit.ledger().touches, 0);
  EXPECT_FALSE(audit.ledger().ok());
  EXPECT_EQ(audit.ledger().first_bad_step, 3);
  EXPECT_EQ(audit.ledger().first_bad, (PairName{PairKind::edge_triangle, 6, 0}));
}

TEST(Audit, sliding_contact_is_certified) {
  const AuditMesh mesh = sheet_and_triangle();
  Positions x0 = sheet_and_triangle_at(0.0);
  x0(2, 3) = 0.0;  // the whole sheet flat
  x0.row(2).tail<3>().setConstant(1e-10);
  Positions x1 = x0;
  x1.row(0).tail<3>().array() -= 3.0;  // across the sheet and over its border
  const Mat3d turn = Eigen::AngleAxisd(0.7, Vec3d(1, 2, 3).normalized()).toRotationMatrix();
  x0 = turn * x0, x1 = turn * x1;  // so that no coordinate axis separates them
  const MotionAudit found = audit_motion(mesh, x0, x1, tolerance);
  EXPECT_GT(found.pairs, 5);
  EXPECT_EQ(found.certified, found.pairs);
}

TEST(Audit, fixed_pairs_are_judged_in_the_first_state_only) {
  AuditMesh mesh = sheet_and_triangle();
  mesh.fixed.assign(7, 1);
  Audit audit(mesh);
  audit.check_state(sheet_and_triangle_at(0.0), 0);
  EXPECT_EQ(audit.ledger().crossings, 3);
  audit.check_state(sheet_and_triangle_at(0.0), 1);
  EXPECT_EQ(audit.ledger().crossings, 3);
  mesh.fixed[5] = 0;  // one moving vertex, of the crossing edge: its pairs are judged always
  Audit moving(mesh);
  moving.check_state(sheet_and_triangle_at(0.0), 0);
  moving.check_state(sheet_and_triangle_at(0.0), 1);
  EXPECT_EQ(moving.ledger().crossings, 3 + 1);  // of edge 4 5 alone a touch: edge 4 6 is fixed
}

TEST(Audit, pairs_that_share_a_vertex_are_exempt_and_no_others) {
  Eigen::Matrix3Xi t(3, 2);
  t << 0, 0, 1, 3, 2, 4;  // triangles 0 1 2 and 0 3 4, folded through each other at vertex 0
  Positions x(3, 5);
  x << 0, 1, 1, 1, 1,      //
      0, -1, 1, 0.1, 0.1,  //
      0, 0, 0, -1, 1;
  const AuditMesh mesh = surface(t);
  StateAudit found = audit_state(mesh, x, true);
  EXPECT_EQ(found.crossings, 2);  // the far edges meet in a point, and no displacement takes them apart
  EXPECT_EQ(found.touches, 0);
  x(0, 3) = x(0, 4) = 0.9;  // now every pair that crosses shares vertex 0, but for the edge opposite to it
  found = audit_state(mesh, x, true);
  EXPECT_EQ(found.crossings, 1);
}

AuditMesh planar_elements() {
  AuditMesh mesh = two_triangles();
  mesh.planar = true;
  return mesh;
}

Positions planar_at(double y) {
  Positions x(3, 6);
  x << 0, 4, 2, 1.1, 3.1, 2.2,           //
      0, 0, 1, y + 1.1, y + 0.9, y + 2,  //
      0, 0, 0, 9, 9, 9;                  // z plays no part
  return x;
}

TEST(Audit, planar_edges_cross_by_orient2d) {
  Audit audit(planar_elements());
  audit.check_state(planar_at(0.5), 0);
  EXPECT_TRUE(audit.ledger().ok());
  audit.check_state(planar_at(-0.5), 1);
  EXPECT_GT(audit.ledger().crossings, 0);
  EXPECT_EQ(audit.ledger().inverted, 0);
  EXPECT_EQ(audit.ledger().first_bad->kind, PairKind::edge_edge_2d);
}

TEST(Audit, a_surface_of_which_nothing_was_judged_is_never_ok) {
  EXPECT_FALSE(AuditLedger{}.ok());
  AuditMesh no_edges = planar_elements();  // as a contact model without edge pairs would list it
  no_edges.edges.resize(2, 0);
  no_edges.points = {0, 1, 2, 3, 4, 5};
  Audit blind(no_edges);
  blind.check_state(planar_at(-0.5), 0);  // the triangles cross
  blind.check_motion(planar_at(-0.5), planar_at(-9.0), 0, tolerance);
  EXPECT_TRUE(blind.ledger().clean());
  EXPECT_EQ(blind.ledger().judged(), 0);
  EXPECT_FALSE(blind.ledger().ok());

  no_edges.obstacles = {{ObstacleKind::sphere, Vec3d(0, -20, 0), Vec3d::UnitZ(), 1.0, false}};
  Audit obstacle_only(no_edges);  // signs of obstacles do not stand in for the pairs of the surface
  obstacle_only.check_state(planar_at(0.5), 0);
  EXPECT_GT(obstacle_only.ledger().obstacle_judged.total(), 0);
  EXPECT_FALSE(obstacle_only.ledger().ok());

  AuditMesh no_vertices = sheet_and_triangle();  // every vertex fixed: no sign of the obstacle is judged
  no_vertices.fixed.assign(7, 1);
  no_vertices.obstacles = {{ObstacleKind::plane, Vec3d(0, 0, -1), Vec3d::UnitZ(), 0.0, false}};
  Audit surface_only(no_vertices);
  surface_only.check_state(sheet_and_triangle_at(0.5), 0);
  EXPECT_GT(surface_only.ledger().pair_queries, 0);
  EXPECT_FALSE(surface_only.ledger().ok());
}

TEST(Audit, loose_particles_are_judged_at_obstacles_alone) {
  AuditMesh particles;
  particles.edges.resize(2, 0), particles.triangles.resize(3, 0);
  particles.points = {0, 1};
  Positions above(3, 2), below(3, 2);
  above << 0, 1, 0, 0, 0.5, 0.25;
  below << 0, 1, 0, 0, 0.5, -0.25;
  Audit nothing_to_meet(particles);
  nothing_to_meet.check_state(above, 0);
  EXPECT_FALSE(nothing_to_meet.ledger().ok());  // nothing was judged

  particles.obstacles = {{ObstacleKind::plane, Vec3d::Zero(), Vec3d::UnitZ(), 0.0, false}};
  Audit on_plane(particles);
  on_plane.check_state(above, 0);
  EXPECT_EQ(on_plane.ledger().judged(), 2);
  EXPECT_TRUE(on_plane.ledger().ok());
  on_plane.check_motion(above, below, 1, tolerance);
  EXPECT_EQ(on_plane.ledger().obstacle_violations, 1);
  EXPECT_FALSE(on_plane.ledger().ok());
}

TEST(Audit, ledger_counts_what_there_is_and_what_was_judged) {
  AuditMesh mesh = planar_elements();
  mesh.obstacles = {{ObstacleKind::sphere, Vec3d(0, -20, 0), Vec3d::UnitZ(), 1.0, false}};
  Audit audit(mesh);
  audit.check_state(planar_at(0.5), 0);
  const AuditLedger first = audit.ledger();
  EXPECT_EQ(first.subjects.edges, 6);
  EXPECT_EQ(first.subjects.triangles, 2);
  EXPECT_EQ(first.subjects.vertices, 6);
  EXPECT_EQ(first.subjects.obstacles, 1);
  EXPECT_EQ(first.pair_queries, 6);  // every edge against all edges
  EXPECT_EQ(first.obstacle_judged.triangles, 2);
  EXPECT_EQ(first.obstacle_judged.total(), 2);  // edges and vertices are parts of the triangles
  EXPECT_EQ(first.judged(), 8);
  audit.check_motion(planar_at(0.5), planar_at(-0.009), 1, tolerance);
  EXPECT_EQ(audit.ledger().pair_queries, 12);              // every vertex against all edges
  EXPECT_EQ(audit.ledger().obstacle_judged.triangles, 3);  // and the one that moves
  EXPECT_GT(audit.ledger().motion_pairs, 0);
  EXPECT_TRUE(audit.ledger().ok());
}

TEST(Audit, prescribed_primitives_that_cross_are_a_fault_of_the_scene) {
  AuditMesh mesh = sheet_and_triangle();
  mesh.prescribed.assign(7, 1);
  mesh.obstacles = {{ObstacleKind::plane, Vec3d(0, 0, -5), Vec3d::UnitZ(), 0.0, false}};
  Audit state(mesh);
  state.check_state(sheet_and_triangle_at(0.0), 2);
  EXPECT_EQ(state.ledger().scene_faults, 3);
  EXPECT_EQ(state.ledger().crossings, 0);
  EXPECT_FALSE(state.ledger().penetrated());
  EXPECT_FALSE(state.ledger().ok());
  EXPECT_EQ(state.ledger().first_fault, (PairName{PairKind::edge_triangle, 6, 0}));
  EXPECT_EQ(state.ledger().first_fault_step, 2);
  EXPECT_FALSE(state.ledger().first_bad);

  Audit motion(mesh);
  motion.check_motion(sheet_and_triangle_at(0.5), sheet_and_triangle_at(-0.5), 3, tolerance);
  EXPECT_EQ(motion.ledger().scene_faults, 3);
  EXPECT_EQ(motion.ledger().violations, 0);
  motion.check_state(sheet_and_triangle_at(-6), 4);  // driven beyond the plane
  EXPECT_EQ(motion.ledger().scene_faults, 6);
  EXPECT_EQ(motion.ledger().obstacle_violations, 0);

  mesh.prescribed[5] = 0;  // one free vertex of the crossing edge: now the solver decides
  Audit free(mesh);
  free.check_state(sheet_and_triangle_at(0.0), 2);
  EXPECT_EQ(free.ledger().scene_faults, 1);  // edge 4 6, at the vertex in the sheet
  EXPECT_EQ(free.ledger().crossings, 2);
}

TEST(Audit, prescribed_primitives_that_cannot_be_certified_are_no_failure_of_the_solver) {
  AuditMesh mesh = sheet_and_triangle();
  const auto touching = [&mesh] {  // the lowest corner comes to rest on the sheet
    return audit_motion(mesh, sheet_and_triangle_at(0.5), sheet_and_triangle_at(0.01), tolerance);
  };
  EXPECT_EQ(touching().unproven, 1);
  EXPECT_EQ(touching().scene_faults, 0);
  mesh.prescribed.assign(7, 1);
  const MotionAudit given = touching();
  EXPECT_EQ(given.unproven, 0);
  EXPECT_EQ(given.scene_faults, 1);
  EXPECT_EQ(given.first_fault, (PairName{PairKind::vertex_triangle, 6, 0, false}));
  EXPECT_EQ(given.pairs, given.certified + given.scene_faults);
}

TEST(Audit, a_vertex_through_the_edge_of_its_own_triangle_is_an_inversion) {
  AuditMesh mesh = planar_elements();
  Positions x0 = planar_at(5.0), x1 = x0;
  x1(1, 5) = 4.0;  // the tip of the upper triangle below its base, edge 3
  const MotionAudit judged = audit_motion(mesh, x0, x1, tolerance);
  EXPECT_EQ(judged.violations, 1);
  mesh.opposite = {2, 0, 1, 5, 3, 4};
  const MotionAudit exempt = audit_motion(mesh, x0, x1, tolerance);
  EXPECT_EQ(exempt.violations, 0);
  EXPECT_EQ(audit_state(mesh, x1, true).inverted, 1);
  EXPECT_GT(audit_motion(mesh, planar_at(0.5), planar_at(-9.0), tolerance).violations, 0);
}

TEST(Audit, planar_vertex_through_an_edge_is_a_violation) {
  const AuditMesh mesh = planar_elements();
  const MotionAudit through = audit_motion(mesh, planar_at(0.5), planar_at(-9.0), tolerance);
  EXPECT_GT(through.violations, 0);
  EXPECT_EQ(through.unproven, 0);
  const MotionAudit free = audit_motion(mesh, planar_at(0.5), planar_at(-0.009), tolerance);
  EXPECT_GT(free.pairs, 0);
  EXPECT_EQ(free.certified, free.pairs);
}

TEST(Audit, inverted_elements_are_counted_apart) {
  Audit audit(planar_elements());
  Positions x = planar_at(5.0);
  x(1, 5) = 4.0;  // the tip of the upper triangle below its base
  audit.check_state(x, 0);
  EXPECT_EQ(audit.ledger().inverted, 1);
  EXPECT_TRUE(audit.ledger().ok());
  x.col(5) = x.col(3);  // without area
  audit.check_state(x, 1);
  EXPECT_EQ(audit.ledger().inverted, 2);
}

TEST(Audit, states_that_are_not_finite_are_not_ok) {
  Audit audit(sheet_and_triangle());
  Positions x = sheet_and_triangle_at(0.5);
  x(0, 0) = std::numeric_limits<double>::quiet_NaN();
  audit.check_state(x, 4);
  EXPECT_FALSE(audit.ledger().ok());
  EXPECT_EQ(audit.ledger().non_finite, 1);
  EXPECT_EQ(audit.ledger().first_bad_step, 4);
  audit.check_motion(sheet_and_triangle_at(0.5), x, 5, tolerance);
  EXPECT_EQ(audit.ledger().non_finite, 2);
}

TEST(Audit, impossible_input_is_a_config_error) {
  AuditMesh mesh = sheet_and_triangle();
  mesh.obstacles = {{ObstacleKind::sphere, Vec3d::Zero(), Vec3d::UnitZ(), -1.0, false}};
  EXPECT_THROW(Audit{mesh}, ConfigError);
  mesh.obstacles = {{ObstacleKind::plane, Vec3d::Zero(), Vec3d::Zero(), 0.0, false}};
  EXPECT_THROW(Audit{mesh}, ConfigError);
  mesh.obstacles.clear();
  mesh.fixed.assign(3, 0);
  EXPECT_THROW(Audit{mesh}, ConfigError);
}

/// Triangles thrown into a box: many crossings and passages.
TEST(Audit, counts_do_not_depend_on_the_number_of_threads) {
  std::mt19937 random(31);
  std::uniform_real_distribution<double> unit(0.0, 3.0);
  constexpr int n = 150;
  Eigen::Matrix3Xi t(3, n);
  Positions x0(3, 3 * n), x1(3, 3 * n);
  for (int i = 0; i < n; ++i) {
    const Vec3d centre(unit(random), unit(random), unit(random)),
        shift = 0.1 * Vec3d(unit(random), unit(random), 1);
    for (int k = 0; k < 3; ++k) {
      t(k, i) = 3 * i + k;
      x0.col(3 * i + k) = centre + 0.2 * Vec3d(unit(random), unit(random), unit(random));
      x1.col(3 * i + k) = x0.col(3 * i + k) + shift;
    }
  }
  const AuditMesh mesh = surface(t);
  const auto both = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return std::pair{audit_state(mesh, x0, true), audit_motion(mesh, x0, x1, tolerance)};
  };
  const auto [state1, motion1] = both(1);
  const auto [state4, motion4] = both(4);
  EXPECT_GT(state1.crossings, 10);
  EXPECT_GT(motion1.violations, 10);
  EXPECT_EQ(motion1.pairs, motion1.certified + motion1.violations + motion1.unproven);
  EXPECT_EQ(state1.crossings, state4.crossings);
  EXPECT_EQ(state1.pairs, state4.pairs);
  EXPECT_EQ(state1.first_bad, state4.first_bad);
  EXPECT_EQ(motion1.violations, motion4.violations);
  EXPECT_EQ(motion1.pairs, motion4.pairs);
  EXPECT_EQ(motion1.first_bad, motion4.first_bad);
}

}  // namespace
}  // namespace bb::audit::audit_test
