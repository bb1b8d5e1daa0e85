// The audit on real meshes: two cubes apart, close and intersecting, and one real step of a cloth on a ball.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "core/audit/audit.hpp"
#include "tests/audit/ply.hpp"
#include "tests/optional_data.hpp"

namespace bb::audit::meshes_test {
namespace {

namespace fs = std::filesystem;

fs::path meshes() { return optional_data("meshes"); }

AuditMesh surface_of(const Ply& ply) {
  std::vector<std::pair<int, int>> edges;
  for (const auto& t : ply.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) edges.push_back(std::minmax(int{t[k]}, int{t[(k + 1) % 3]}));
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  AuditMesh mesh;
  mesh.triangles = ply.triangles;
  mesh.edges.resize(2, static_cast<Eigen::Index>(edges.size()));
  for (std::size_t i = 0; i < edges.size(); ++i) {
    mesh.edges.col(static_cast<Eigen::Index>(i)) << edges[i].first, edges[i].second;
  }
  return mesh;
}

StateAudit state_of(const char* name) {
  const Ply ply = read_ply(meshes() / name);
  const AuditMesh mesh = surface_of(ply);
  return audit_state(mesh, ply.x, true);
}

TEST(Meshes, cubes_cross_only_where_they_intersect) {
  if (!fs::is_directory(meshes())) GTEST_SKIP() << "no meshes at " << meshes();
  for (const char* name : {"two-cubes-far.ply", "two-cubes-close.ply"}) {
    const StateAudit found = state_of(name);
    EXPECT_GT(found.pairs, 100) << name;
    EXPECT_EQ(found.crossings, 0) << name;
    EXPECT_EQ(found.touches, 0) << name;
  }
  EXPECT_GT(state_of("two-cubes-intersecting.ply").crossings, 0);
}

double milliseconds(std::chrono::steady_clock::time_point since) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - since).count();
}

// A part of the cloth, to stay short without optimisation. The input is not free of crossings: nothing is
// asserted of them but that both states and the motion are judged and that they agree.
TEST(Meshes, part_of_a_cloth_on_a_ball_is_judged) {
  if (!fs::is_directory(meshes())) GTEST_SKIP() << "no meshes at " << meshes();
  Ply before = read_ply(meshes() / "cloth_ball92.ply");
  const Ply after = read_ply(meshes() / "cloth_ball93.ply");
  before.triangles = before.triangles.leftCols(8000).eval();
  const AuditMesh mesh = surface_of(before);

  auto start = std::chrono::steady_clock::now();
  const StateAudit state = audit_state(mesh, before.x, true);
  std::printf("state: %ld pairs, %ld crossings, %ld touches in %.0f ms\n", state.pairs, state.crossings,
              state.touches, milliseconds(start));
  start = std::chrono::steady_clock::now();
  const MotionAudit motion = audit_motion(mesh, before.x, after.x, 1e-9);
  std::printf("motion: %ld pairs, %ld certified, %ld violations, %ld unproven in %.0f ms\n", motion.pairs,
              motion.certified, motion.violations, motion.unproven, milliseconds(start));

  EXPECT_GT(state.pairs, 1000);
  EXPECT_GT(motion.pairs, 1000);
  EXPECT_EQ(motion.pairs, motion.certified + motion.violations + motion.unproven);
  const StateAudit end = audit_state(mesh, after.x, true);
  if (end.crossings != state.crossings) {
    EXPECT_GT(motion.violations + motion.unproven, 0);
  }
}

}  // namespace
}  // namespace bb::audit::meshes_test
