// What the audit gets of a scene: the whole surface, whatever pairs the contact model makes of it.
#include "experiments/run/audit_mesh.hpp"

#include <gtest/gtest.h>

#include "experiments/config/parse.hpp"
#include "experiments/run/audit_verdict.hpp"

namespace bb {
namespace {

Scene drape2d(const std::string& pairs) {
  return build_scene(parse_config(R"({"schema": "barrierbench.config/1", "formulation": "log",
    "scene": {"name": "drape2d", "variant": "stack", "pairs": ")" +
                                      pairs + R"("}})",
                                  "test"));
}

TEST(AuditMesh, PlanarSurfaceIsTheSameForEveryContactModel) {
  const audit::AuditMesh edges = make_audit_mesh(drape2d("point_edge"));
  const audit::AuditMesh vertices = make_audit_mesh(drape2d("vertex_vertex"));
  EXPECT_EQ(edges.edges.cols(), 3 * 2 * 20);  // of each of three sheets of 20 x 2 vertices: 40
  EXPECT_EQ(edges.edges, vertices.edges);
  EXPECT_EQ(edges.opposite, vertices.opposite);
  EXPECT_EQ(edges.points, vertices.points);
  EXPECT_EQ(edges.obstacles.size(), 1U);
}

TEST(AuditMesh, PlanarInteriorVerticesAreJudgedToo) {
  const audit::AuditMesh mesh = make_audit_mesh(build_scene(parse_config(
      R"({"schema": "barrierbench.config/1", "formulation": "log", "scene": {"name": "drape2d", "variant": "pinned", "n": 10}})",
      "test")));
  EXPECT_EQ(mesh.edges.cols(), 36);
  EXPECT_EQ(mesh.points.size(), 64U);
  EXPECT_EQ(std::count(mesh.prescribed.begin(), mesh.prescribed.end(), 1), 10);
  EXPECT_EQ(mesh.prescribed, mesh.fixed);
}

TEST(AuditMesh, EdgesAreComputedFromTheTriangles) {
  Scene scene = drape2d("vertex_vertex");
  const audit::AuditMesh whole = make_audit_mesh(scene);
  scene.surface_edges.clear();
  EXPECT_EQ(make_audit_mesh(scene).edges, whole.edges);
  EXPECT_GT(whole.edges.cols(), 0);
}

TEST(AuditVerdict, SaysWhatTheContactModelAllows) {
  Scene scene = drape2d("vertex_vertex");
  const audit::AuditMesh mesh = make_audit_mesh(scene);
  audit::AuditLedger ledger;
  EXPECT_EQ(judge_audit(scene, mesh, ledger).outcome, Outcome::unproven);  // nothing judged
  EXPECT_NE(judge_audit(scene, mesh, ledger).detail.find("nothing was judged"), std::string::npos);
  ledger.pair_queries = 3;
  EXPECT_EQ(judge_audit(scene, mesh, ledger).outcome, Outcome::ok);
  ledger.crossings = 2;
  const Verdict allowed = judge_audit(scene, mesh, ledger);
  EXPECT_EQ(allowed.outcome, Outcome::penetration);
  EXPECT_NE(allowed.detail.find("vertex_vertex has no edge pairs"), std::string::npos);
  scene.planar_pairs = PlanarPairs::point_edge;
  EXPECT_EQ(judge_audit(scene, mesh, ledger).detail.find("vertex_vertex"), std::string::npos);
  ledger.scene_faults = 1;
  ledger.first_fault = audit::PairName{audit::PairKind::edge_edge_2d, 0, 41};
  const Verdict fault = judge_audit(scene, mesh, ledger);
  EXPECT_EQ(fault.outcome, Outcome::invalid_scene);
  EXPECT_NE(fault.detail.find("sheet0["), std::string::npos) << fault.detail;
  EXPECT_NE(fault.detail.find("sheet1["), std::string::npos) << fault.detail;
  ledger.first_fault = audit::PairName{audit::PairKind::vertex_edge_2d, 0, 41, false};
  const std::string close = judge_audit(scene, mesh, ledger).detail;
  EXPECT_NE(close.find("cannot be certified not to pass through"), std::string::npos) << close;
}

}  // namespace
}  // namespace bb
