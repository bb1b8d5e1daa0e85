// Motions of close bodies of every kind, and of bodies close to obstacles of every kind: what is certified is free by a
// brute force that goes on by no more than the gap each time, and what is free by it is certified.
#include <gtest/gtest.h>

#include "core/audit/motion_audit.hpp"
#include "tests/contact/close_bodies.hpp"

namespace bb::audit::close_motions_test {
namespace {

using test::CloseBodies;
using test::TruePair;

AuditMesh mesh_of(const Scene& scene) {
  AuditMesh mesh;
  mesh.planar = scene.planar;
  std::vector<std::array<int, 2>> edges = scene.surface_edges;
  const auto triangles = scene.planar ? scene.membrane_triangles() : scene.surface_triangles;
  mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      mesh.triangles(k, static_cast<int>(t)) = triangles[t][static_cast<std::size_t>(k)];
      if (!scene.planar)
        edges.push_back(
            {triangles[t][static_cast<std::size_t>(k)], triangles[t][static_cast<std::size_t>((k + 1) % 3)]});
    }
  }
  mesh.edges.resize(2, static_cast<Eigen::Index>(edges.size()));
  for (std::size_t e = 0; e < edges.size(); ++e)
    mesh.edges.col(static_cast<Eigen::Index>(e)) << edges[e][0], edges[e][1];
  mesh.points = scene.surface_vertices;
  for (const Obstacle& o : scene.obstacles)
    mesh.obstacles.push_back({static_cast<ObstacleKind>(o.kind), o.point, o.axis, o.radius, o.inside});
  return mesh;
}

/// Whether the least gap stays positive on x0 -> x1: a gap falls by at most twice the longest way. Nothing where a gap
/// stays so small that this takes too long.
std::optional<bool> stays_free(const CloseBodies& bodies, const Positions& x1) {
  const Positions& x0 = bodies.scene.x0;
  const double fall = 2 * (x1 - x0).colwise().norm().maxCoeff() * (1 + 1e-9);
  int left = 5000;
  for (double t = 0; t < 1; --left) {
    if (left == 0) return std::nullopt;
    const double gap = least_true_gap(bodies.scene, bodies.pairs, x0 + t * (x1 - x0));
    if (!(gap > 1e-11)) return false;
    t += gap / fall;
  }
  return true;
}

struct Tally {
  int free = 0, hit = 0, close = 0, obstacles = 0;
};

void expect_the_brute_force(CloseBodies bodies, double way, double stray, unsigned seed, Tally& tally) {
  // between a vertex and a lone edge in space nothing can pass
  std::erase_if(bodies.pairs, [&](const TruePair& p) {
    return !bodies.scene.planar && p.obstacle < 0 && p.first.size() + p.second.size() < 4;
  });
  if (bodies.pairs.empty()) return;
  const double start = least_true_gap(bodies.scene, bodies.pairs, bodies.scene.x0);
  const Positions x1 = approach(bodies, way, stray, seed);
  const std::optional<bool> known = stays_free(bodies, x1);
  if (!known) return;
  const bool expected = *known;
  const MotionAudit found = audit_motion(mesh_of(bodies.scene), bodies.scene.x0, x1, 1e-9);
  const long bad = found.violations + found.unproven + found.obstacle_violations + found.obstacle_unproven;
  ASSERT_EQ(bad == 0, expected) << "seed " << seed << ", gap " << start << ", way " << way << ", violations "
                                << found.violations << ", unproven " << found.unproven << ", at obstacles "
                                << found.obstacle_violations << ", " << found.obstacle_unproven;
  ++(expected ? tally.free : tally.hit);
  tally.close += expected && start < 1e-6;
  tally.obstacles += !bodies.scene.obstacles.empty();
}

TEST(CloseMotions, AreCertifiedWhereAndOnlyWhereTheyStayFree) {
  Tally tally;
  unsigned seed = 1;
  test::for_each_close_scene(6, 20000, [&](CloseBodies bodies) {
    std::fill(bodies.scene.offset.begin(), bodies.scene.offset.end(), 0.0);
    for (TruePair& pair : bodies.pairs) pair.offset = 0;
    if (bodies.pairs.empty()) return;
    std::mt19937_64 rng(seed);
    test::detail::bring_to(bodies, 0.01 * std::pow(10.0, test::between(rng, -6, 0)));
    // one piece, which must not meet itself, moves as a whole
    const double way = std::pow(10.0, test::between(rng, -5, 0)) * (seed % 3 == 0 ? -1 : 1);
    const bool apart = bodies.scene.obstacles.empty() || bodies.scene.n_vertices() < 4;
    expect_the_brute_force(bodies, way, apart ? 0.02 * std::abs(way) : 0, ++seed, tally);
  });
  EXPECT_GT(tally.free, 200);
  EXPECT_GT(tally.hit, 200);
  EXPECT_GT(tally.close, 10);
  EXPECT_GT(tally.obstacles, 200);
}

}  // namespace
}  // namespace bb::audit::close_motions_test
