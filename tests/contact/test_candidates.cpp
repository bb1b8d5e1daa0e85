// Candidate pairs of scenes against all pairs of primitives, and which pairs never exist.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "core/contact/candidates.hpp"
#include "core/contact/pair_geometry.hpp"
#include "core/contact/pair_row.hpp"
#include "core/contact/row_rule.hpp"
#include "core/geometry/accd.hpp"
#include "tests/contact/contact_scenes.hpp"

namespace bb::test::candidates_test {
namespace {

Candidates candidates_of(const Scene& scene, const Positions& x0, const Positions& x1) {
  const Surface surface(scene);
  BroadPhase broad_phase(surface, {}, plan_contact(scene));
  Candidates out;
  broad_phase.update(x0, x1, out);
  return out;
}

/// Every pair of kind K that comes within its own d_hat (the rest rule's) and offset at a sample of the motion.
template <PairKind K, class A, class B, class Allowed>
std::vector<IndexPair> close_pairs(const Scene& scene, const A& a, const B& b, const Positions& x0,
                                   const Positions& x1, const Allowed& allowed) {
  const Surface surface(scene);
  std::vector<IndexPair> out;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) {
      if (K == PairKind::edge_edge && j <= i) continue;
      if (!a.free[i] && !b.free[j]) continue;
      if (!allowed(a.vertices[i], b.vertices[j])) continue;
      const IndexPair index{static_cast<int>(i), static_cast<int>(j)};
      const ContactPair<K> pair = contact_pair<K>(surface, index);
      for (double t : {0.0, 0.3, 0.7, 1.0}) {
        const Positions x = x0 + t * (x1 - x0);
        const double gap = closest_points<K, double>(gather(x, pair.vertex)).d - pair.law.offset;
        if (gap > activation_distance<K>(surface, pair.vertex.data(), pair.law)) continue;
        out.push_back(index);
        break;
      }
    }
  }
  return out;
}

void expect_contains(const std::vector<IndexPair>& all, const std::vector<IndexPair>& needed) {
  EXPECT_GT(needed.size(), 20U);
  EXPECT_TRUE(std::includes(all.begin(), all.end(), needed.begin(), needed.end()));
  EXPECT_LT(all.size(), 60 * needed.size());  // and is not simply every pair
}

Scene soup_scene() {
  Scene scene;
  const auto [v1, t1] = soup(120, 0.15, 1);
  const auto [v2, t2] = soup(80, 0.15, 2);
  add_body(scene, "free", v1, t1, 0.05);
  add_body(scene, "given", v2, t2, 0.1, true, 0.01);
  return scene;
}

TEST(Candidates, HoldEveryClosePairOfASoup) {
  const Scene scene = soup_scene();
  const Surface s(scene);
  Positions x1 = random_motion(scene.rest, 0.05, 3);
  x1.rightCols(240) = scene.rest.rightCols(240);
  const Candidates c = candidates_of(scene, scene.rest, x1);

  const auto disjoint_pt = [](const std::array<int, 1>& p, const std::array<int, 3>& t) {
    return Surface::disjoint(p[0], t);
  };
  const auto disjoint_ee = [](const std::array<int, 2>& a, const std::array<int, 2>& b) {
    return Surface::disjoint(a, b);
  };
  expect_contains(c.point_triangle, close_pairs<PairKind::point_triangle>(scene, s.points, s.triangles,
                                                                          scene.rest, x1, disjoint_pt));
  expect_contains(c.edge_edge,
                  close_pairs<PairKind::edge_edge>(scene, s.edges, s.edges, scene.rest, x1, disjoint_ee));
}

/// Two layers of cloth with a mesh of half d_hat, one above the other.
Scene dense_layers(double apart) {
  Scene scene;
  for (int layer = 0; layer < 2; ++layer) {
    const auto [vertices, triangles] = grid(8, 8, 0.05, Vec3d(0.02 * layer, 0.01 * layer, apart * layer));
    add_body(scene, layer == 0 ? "lower" : "upper", vertices, triangles, 0.1);
  }
  return scene;
}

/// Pairs of kind K with a row or a time below 1 on the motion, of which each has to be a candidate.
template <PairKind K, class A, class B, class Allowed>
std::size_t expect_all_that_matter(const Scene& scene, const std::vector<IndexPair>& candidates, const A& a,
                                   const B& b, const Positions& x1, const Allowed& allowed) {
  const Surface surface(scene);
  std::size_t n = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = K == PairKind::edge_edge ? i + 1 : 0; j < b.size(); ++j) {
      if (!allowed(a.vertices[i], b.vertices[j])) continue;
      const IndexPair index{static_cast<int>(i), static_cast<int>(j)};
      const ContactPair<K> pair = contact_pair<K>(surface, index);
      const auto from = gather(scene.x0, pair.vertex), to = gather(x1, pair.vertex);
      const double park = ContactOptions().min_gap_fraction * pair.law.d_hat,
                   row = activation_distance<K>(surface, pair.vertex.data(), pair.law);
      bool matters = accd<K, double>(from, to, pair.law.offset, park).hit;
      for (const double t : {0.0, 0.5, 1.0}) {
        const auto x = ((1 - t) * from + t * to).eval();
        matters = matters || closest_points<K, double>(x).d - pair.law.offset < row;
      }
      if (!matters) continue;
      EXPECT_TRUE(std::binary_search(candidates.begin(), candidates.end(), index)) << i << " " << j;
      ++n;
    }
  }
  return n;
}

/// What the rest rule drops, or is beyond reach across a corner, is no candidate; a row or a bound never gets lost: on a
/// flat sheet, a crumpled one and motions of any size.
TEST(Candidates, OfADenseMeshAreThePairsThatMatterAndFewMore) {
  std::size_t n_matter = 0, n_candidates = 0;
  for (const double apart : {0.099, 0.03}) {
    Scene scene = dense_layers(apart);
    const Surface s(scene);
    for (const double crumpled : {0.0, 0.01, 0.04}) {
      scene.x0 = random_motion(scene.rest, crumpled, 5);
      for (const double size : {0.0, 0.002, 0.03}) {
        const Positions x1 = random_motion(scene.x0, size, 7);
        const Candidates c = candidates_of(scene, scene.x0, x1);
        const std::size_t n = expect_all_that_matter<PairKind::point_triangle>(
                                  scene, c.point_triangle, s.points, s.triangles, x1,
                                  [](const auto& p, const auto& t) { return Surface::disjoint(p[0], t); }) +
                              expect_all_that_matter<PairKind::edge_edge>(
                                  scene, c.edge_edge, s.edges, s.edges, x1,
                                  [](const auto& p, const auto& q) { return Surface::disjoint(p, q); });
        n_matter += n;
        if (crumpled == 0 && size == 0) {
          EXPECT_LT(c.point_triangle.size() + c.edge_edge.size(), 8 * n) << apart;
          n_candidates += n;
        }
      }
    }
  }
  EXPECT_GT(n_candidates, 500U);
  EXPECT_GT(n_matter, 20000U);
}

/// A fall of all bodies adds no pairs; a fall of one of them adds those that it passes.
TEST(Candidates, DependOnRelativeMotion) {
  const Scene scene = soup_scene();
  const Surface s(scene);
  const auto disjoint = [](const std::array<int, 2>& a, const std::array<int, 2>& b) {
    return Surface::disjoint(a, b);
  };
  const Positions shaken = random_motion(scene.rest, 0.05, 3);
  const Candidates still = candidates_of(scene, scene.rest, shaken);
  Positions all = shaken, some = shaken;
  all.colwise() += Vec3d(0.3, -2, 1e3);
  const Candidates fallen = candidates_of(scene, scene.rest, all);
  expect_contains(fallen.edge_edge,
                  close_pairs<PairKind::edge_edge>(scene, s.edges, s.edges, scene.rest, all, disjoint));
  EXPECT_LT(fallen.edge_edge.size(), 2 * still.edge_edge.size());

  some.leftCols(360).colwise() += Vec3d(0, 0, 0.2);  // the free soup alone
  const Candidates passed = candidates_of(scene, scene.rest, some);
  const auto needed = close_pairs<PairKind::edge_edge>(scene, s.edges, s.edges, scene.rest, some, disjoint);
  expect_contains(passed.edge_edge, needed);
}

TEST(Candidates, NeverHoldAdjacentOrWhollyGivenPairs) {
  Scene scene;
  const auto [vertices, triangles] = grid(6, 6, 0.1);
  add_body(scene, "cloth", vertices, triangles, 0.3);
  const auto [v2, t2] = grid(3, 3, 0.1, Vec3d(0, 0, 0.1));
  const int first = add_body(scene, "floor", v2, t2, 0.3, true);
  const Surface s(scene);
  const Positions x = 0.5 * scene.rest;
  const Candidates c = candidates_of(scene, x, x);

  ASSERT_GT(c.point_triangle.size(), 100U);
  ASSERT_GT(c.edge_edge.size(), 100U);
  for (const IndexPair& p : c.point_triangle) {
    const int v = s.points.vertices[at(p.first)][0];
    const auto& t = s.triangles.vertices[at(p.second)];
    EXPECT_TRUE(Surface::disjoint(v, t));
    EXPECT_TRUE(v < first || t[0] < first);
  }
  for (const IndexPair& p : c.edge_edge) {
    const auto &a = s.edges.vertices[at(p.first)], &b = s.edges.vertices[at(p.second)];
    EXPECT_TRUE(Surface::disjoint(a, b));
    EXPECT_TRUE(a[0] < first || b[0] < first);
    EXPECT_LT(p.first, p.second);
  }
}

TEST(Surface, HasNoMorePrimitivesThanPairsCanName) {
  check_primitive_count("edges", 7, 7);
  try {
    check_primitive_count("edges", 8, 7);
    FAIL() << "8 were accepted";
  } catch (const std::length_error& error) {
    EXPECT_STREQ(error.what(), "contact: 8 edges in the surface; at most 7");
  }
  EXPECT_THROW(check_primitive_count("points", std::size_t{1} << 30), std::length_error);
  const PairId last =
      pair_id(3, most_primitives, most_primitives);  // in three fields without a bit in common
  EXPECT_EQ(last >> 60, 3U);
  EXPECT_EQ(last >> 30 & most_primitives, most_primitives);
  EXPECT_EQ(last & most_primitives, most_primitives);
}

TEST(Candidates, SameForAnyNumberOfThreads) {
  const Scene scene = soup_scene();
  const Positions x1 = random_motion(scene.rest, 0.2, 3);
  Candidates reference;
  for (std::size_t threads : {1, 2, 5}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    const Candidates c = candidates_of(scene, scene.rest, x1);
    if (threads == 1) reference = c;
    EXPECT_EQ(c.point_triangle, reference.point_triangle);
    EXPECT_EQ(c.edge_edge, reference.edge_edge);
  }
  EXPECT_GT(reference.edge_edge.size(), 100U);
}

Scene planar_scene(PlanarPairs pairs) {
  Scene scene;
  scene.planar = true;
  scene.planar_pairs = pairs;
  const auto [vertices, triangles] = grid(2, 2, 1.0);
  add_body(scene, "sheet", vertices, {}, 3.0);
  scene.membranes.emplace_back().triangles = triangles;
  if (pairs == PlanarPairs::point_edge) {
    scene.surface_edges = {{0, 1}, {1, 2}, {2, 5}, {5, 8}, {8, 7}, {7, 6}, {6, 3}, {3, 0}};
    scene.surface_vertices = {0, 1, 2, 3, 5, 6, 7, 8};
  }
  return scene;
}

TEST(Candidates, PlanarVertexPairsAreThoseWithoutAMeshEdge) {
  const Scene scene = planar_scene(PlanarPairs::vertex_vertex);
  const Positions x = 0.3 * scene.rest;  // nearer than the rest rule requires
  const Candidates c = candidates_of(scene, x, x);
  // 9 vertices have 36 pairs; the grid has 12 straight edges and 4 diagonals
  EXPECT_EQ(c.point_point.size(), 20U);
  EXPECT_TRUE(c.point_edge.empty() && c.point_triangle.empty() && c.edge_edge.empty());
  EXPECT_TRUE(std::binary_search(c.point_point.begin(), c.point_point.end(), IndexPair{0, 8}));
  EXPECT_FALSE(std::binary_search(c.point_point.begin(), c.point_point.end(), IndexPair{0, 4}));
  EXPECT_TRUE(std::binary_search(c.point_point.begin(), c.point_point.end(), IndexPair{1, 3}));
}

TEST(Candidates, PlanarSpringsOfOneBodyAreMeshEdgesAndStitchesAreNot) {
  Scene scene;
  scene.planar = true;
  scene.planar_pairs = PlanarPairs::vertex_vertex;
  add_body(scene, "rope", {Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(2, 0, 0)}, {}, 3.0);
  add_body(scene, "bead", {Vec3d(2, 1, 0)}, {}, 3.0);
  scene.springs.edges = {{0, 1}, {1, 2}, {2, 3}};
  const Positions x = 0.3 * scene.rest;
  const Candidates c = candidates_of(scene, x, x);
  const std::vector<IndexPair> expected{{0, 2}, {0, 3}, {1, 3}, {2, 3}};
  EXPECT_EQ(c.point_point, expected);
}

TEST(Candidates, PlanarPointEdgeSkipsTheEdgesOfAVertexsOwnTriangles) {
  const Scene scene = planar_scene(PlanarPairs::point_edge);
  const Surface s(scene);
  const Positions x = 0.3 * scene.rest;
  const Candidates c = candidates_of(scene, x, x);
  // 8 vertices x 8 edges less 16 end points. The triangles on boundary edges have their third corner at
  // 4 (inside, no point), or, in the two corners that the diagonal cuts off, on the boundary: triangles
  // (1 2 5), (1 5 4) and (3 7 6), (3 4 7) give edge 1-2 corner 5, edge 2-5 corner 1, edge 7-6 corner 3,
  // edge 6-3 corner 7. The other corners belong to edges 0-1, 3-0, 5-8, 8-7, whose third corner is 4.
  EXPECT_EQ(c.point_edge.size(), 64U - 16U - 4U);
  EXPECT_TRUE(c.point_point.empty() && c.point_triangle.empty() && c.edge_edge.empty());
  for (const IndexPair& p : c.point_edge) {
    EXPECT_FALSE(s.points.vertices[at(p.first)][0] == 5 &&
                 s.edges.vertices[at(p.second)] == (std::array{1, 2}));
  }
}

TEST(Candidates, NothingToDoWithoutSurfaceOrWithoutFreeVertices) {
  Scene scene;
  EXPECT_FALSE(ContactSystem(scene, {}).active());
  const auto [vertices, triangles] = grid(2, 2, 1.0);
  add_body(scene, "floor", vertices, triangles, 0.1, true);
  EXPECT_FALSE(ContactSystem(scene, {}).active());
  scene.obstacles.push_back({});
  EXPECT_FALSE(ContactSystem(scene, {}).active());
  add_body(scene, "cloth", vertices, triangles, 0.1);
  EXPECT_TRUE(ContactSystem(scene, {}).active());
}

}  // namespace
}  // namespace bb::test::candidates_test
