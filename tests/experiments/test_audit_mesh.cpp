// What the audit gets of a scene: the whole surface, whatever pairs the contact model makes of it.
#include "experiments/run/audit_mesh.hpp"

#include <gtest/gtest.h>

#include "experiments/config/parse.hpp"
#include "experiments/run/audit_verdict.hpp"

namespace bb::audit_mesh_test {
namespace {

Scene drape2d(const std::string& pairs) {
  return build_scene(parse_config(R"({"schema": "barrierbench.config/1", "formulation": "log",
    "scene": {"name": "drape2d", "variant": "stack", "pairs": ")" +
                                      pairs + R"("}})",
                                  "test"));
}

TEST(AuditMesh, PlanarSurfaceIsTheSameForEveryContactModel) {
  const audit::AuditMesh edges = make_audit_mesh(drape2d("point_edge"), 0.01);
  const audit::AuditMesh vertices = make_audit_mesh(drape2d("vertex_vertex"), 0.01);
  EXPECT_EQ(edges.edges.cols(), 3 * 2 * 20);  // of each of three sheets of 20 x 2 vertices: 40
  EXPECT_EQ(edges.edges, vertices.edges);
  EXPECT_EQ(edges.opposite, vertices.opposite);
  EXPECT_EQ(edges.points, vertices.points);
  EXPECT_EQ(edges.obstacles.size(), 1U);
}

TEST(AuditMesh, PlanarInteriorVerticesAreJudgedToo) {
  const audit::AuditMesh mesh = make_audit_mesh(
      build_scene(parse_config(
          R"({"schema": "barrierbench.config/1", "formulation": "log", "scene": {"name": "drape2d", "variant": "pinned", "n": 10}})",
          "test")),
      0.01);
  EXPECT_EQ(mesh.edges.cols(), 36);
  EXPECT_EQ(mesh.points.size(), 64U);
  EXPECT_EQ(std::count(mesh.prescribed.begin(), mesh.prescribed.end(), 1), 10);
  EXPECT_EQ(mesh.prescribed, mesh.fixed);
}

TEST(AuditMesh, EdgesAreComputedFromTheTriangles) {
  Scene scene = drape2d("vertex_vertex");
  const audit::AuditMesh whole = make_audit_mesh(scene, 0.01);
  scene.surface_edges.clear();
  EXPECT_EQ(make_audit_mesh(scene, 0.01).edges, whole.edges);
  EXPECT_GT(whole.edges.cols(), 0);
}

TEST(AuditMesh, PrescribedVerticesOfOneMotionAreOneRigidBody) {
  Scene scene = drape2d("point_edge");
  scene.pins = {{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 4}};
  scene.motions.assign(5, PrescribedMotion{});
  scene.motions[1].velocity = scene.motions[2].velocity = Vec3d(1, 0, 0);
  scene.motions[3].angular_velocity = 1;
  const audit::AuditMesh mesh = make_audit_mesh(scene, 0.01);
  EXPECT_EQ(mesh.motion[0], mesh.motion[4]) << "both stand still";
  EXPECT_EQ(mesh.motion[1], mesh.motion[2]);
  EXPECT_GE(mesh.motion[3], 0);
  EXPECT_EQ(mesh.motion[5], -1) << "free";
  EXPECT_NE(mesh.motion[0], mesh.motion[1]);
  EXPECT_NE(mesh.motion[1], mesh.motion[3]);
  EXPECT_EQ(make_audit_mesh(scene, 1.5).motion[3], mesh.motion[3]);
  EXPECT_EQ(make_audit_mesh(scene, 1.6).motion[3], -1)
      << "straight paths of more than a quarter turn squeeze it";
  EXPECT_EQ(mesh.thickness, scene.offset);
}

TEST(AuditMesh, PairsThatAStepIsProvenForAreJudgedAtItsEnd) {
  Scene scene = drape2d("point_edge");
  EXPECT_TRUE(make_audit_mesh(scene, 0.01).judged.late.empty());
  const int obstacle = static_cast<int>(scene.bodies.size());
  scene.collisions.pairs = {{0, 0, CollisionKind::audited, ""},
                            {0, 1, CollisionKind::proximity, ""},
                            {1, obstacle, CollisionKind::audited, ""}};
  const audit::JudgedPairs judged = make_audit_mesh(scene, 0.01).judged;
  EXPECT_EQ(judged.late, (std::vector<std::array<int, 2>>{{0, 0}, {1, obstacle}}));
  EXPECT_EQ(judged.owner, scene.body);
  EXPECT_EQ(judged.n_bodies, obstacle);
}

TEST(AuditVerdict, NamesWhatEntersAnObstacle) {
  const Scene scene = drape2d("point_edge");
  const audit::AuditMesh mesh = make_audit_mesh(scene, 0.01);
  using audit::PairKind;
  EXPECT_EQ(describe(scene, mesh, {PairKind::edge_obstacle, 0, 0}),
            "edge sheet0[0 1] enters obstacle " + scene.obstacles[0].name);
  const std::string near = describe(scene, mesh, {PairKind::triangle_obstacle, 0, 0, false});
  EXPECT_NE(near.find("triangle sheet0["), std::string::npos) << near;
  EXPECT_NE(near.find("cannot be certified not to enter obstacle"), std::string::npos) << near;
}

TEST(AuditVerdict, AKindOfPrimitiveThatWasNeverAskedIsNotOk) {
  const Scene scene = drape2d("point_edge");
  const audit::AuditMesh mesh = make_audit_mesh(scene, 0.01);
  audit::AuditLedger ledger;
  ledger.pair_queries = 3, ledger.subjects.obstacles = 1;
  ledger.subjects.at_obstacles = {0, 0, 38};
  ledger.obstacle_judged.vertices = 60;  // as an audit of vertices alone would count
  const Verdict verdict = judge_audit(scene, mesh, ledger);
  EXPECT_EQ(verdict.outcome, Outcome::unproven);
  EXPECT_NE(verdict.detail.find("0 of 38 triangles"), std::string::npos) << verdict.detail;
  ledger.obstacle_judged.triangles = 38;
  EXPECT_EQ(judge_audit(scene, mesh, ledger).outcome, Outcome::ok);
}

TEST(AuditVerdict, SaysWhatTheContactModelAllows) {
  Scene scene = drape2d("vertex_vertex");
  const audit::AuditMesh mesh = make_audit_mesh(scene, 0.01);
  audit::AuditLedger ledger;
  EXPECT_EQ(judge_audit(scene, mesh, ledger).outcome, Outcome::unproven);  // nothing judged
  EXPECT_NE(judge_audit(scene, mesh, ledger).detail.find("nothing was judged"), std::string::npos);
  ledger.pair_queries = 3;
  EXPECT_EQ(judge_audit(scene, mesh, ledger).outcome, Outcome::ok);
  ledger.crossings = 2;
  const Verdict allowed = judge_audit(scene, mesh, ledger);
  EXPECT_EQ(allowed.outcome, Outcome::penetration);
  EXPECT_NE(allowed.detail.find("vertex_vertex has no edge pairs"), std::string::npos);
  ledger.crossings = 0, ledger.obstacle_violations = 1, ledger.obstacle_by_vertex = 1;
  EXPECT_EQ(judge_audit(scene, mesh, ledger).detail.find("vertex_vertex"), std::string::npos)
      << "a vertex in an obstacle is no matter of edges";
  ledger.obstacle_by_vertex = 0;
  EXPECT_NE(judge_audit(scene, mesh, ledger).detail.find("vertex_vertex has no edge pairs"),
            std::string::npos);
  scene.planar_pairs = PlanarPairs::point_edge;
  EXPECT_EQ(judge_audit(scene, mesh, ledger).detail.find("vertex_vertex"), std::string::npos);
  ledger.scene_faults = 1;
  ledger.first_fault = audit::PairName{audit::PairKind::edge_edge_2d, 0, 41};
  const Verdict fault = judge_audit(scene, mesh, ledger);
  EXPECT_EQ(fault.outcome, Outcome::given_parts_cross);
  EXPECT_NE(fault.detail.find("sheet0["), std::string::npos) << fault.detail;
  EXPECT_NE(fault.detail.find("sheet1["), std::string::npos) << fault.detail;
  ledger.first_fault = audit::PairName{audit::PairKind::vertex_edge_2d, 0, 41, false};
  const std::string close = judge_audit(scene, mesh, ledger).detail;
  EXPECT_NE(close.find("cannot be certified not to pass through"), std::string::npos) << close;
}

}  // namespace
}  // namespace bb::audit_mesh_test
