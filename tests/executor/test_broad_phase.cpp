// Candidates found on an executor: those of the CPU path, of all pairs of boxes, and in any order the same.
#include <gtest/gtest.h>

#include "core/contact/pair_geometry.hpp"
#include "core/contact/row_rule.hpp"
#include "core/exec/counting_executor.hpp"
#include "tests/contact/far_bodies.hpp"
#include "tests/contact/obstacle_scenes.hpp"
#include "tests/contact/rods.hpp"
#include "tests/executor/contact_motion.hpp"
#include "tests/executor/tested_executor.hpp"

namespace bb::test::executor_broad_phase_test {
namespace {

using exec::Index;

std::size_t expect_same(const Candidates& found, const Candidates& expected) {
  EXPECT_EQ(found.point_point, expected.point_point);
  EXPECT_EQ(found.point_edge, expected.point_edge);
  EXPECT_EQ(found.point_triangle, expected.point_triangle);
  EXPECT_EQ(found.edge_edge, expected.edge_edge);
  EXPECT_EQ(found.obstacle, expected.obstacle);
  EXPECT_EQ(found.obstacle_edge, expected.obstacle_edge);
  EXPECT_EQ(found.obstacle_triangle, expected.obstacle_triangle);
  return expected.point_point.size() + expected.point_edge.size() + expected.point_triangle.size() +
         expected.edge_edge.size() + expected.obstacle.size() + expected.obstacle_edge.size() +
         expected.obstacle_triangle.size();
}

Candidates found(const Scene& scene, const Positions& x0, const Positions& x1) {
  test::TestedExecutor executor;
  ExecutorMotion motion(executor, scene, x0, x1);
  motion.update();
  return lists_of(motion.candidates);
}

TEST(ExecutorBroadPhase, FindsWhatTheCpuPathFindsInSoups) {
  std::size_t n_pairs[5] = {};
  const auto expect_that_of_the_cpu_path = [&](const Scene& scene, unsigned seed) {
    for (const double size : {0.5, 1e-2, 1e-5}) {
      const Positions x1 = moved(scene, size, seed + 7);
      const Candidates expected = cpu_candidates(scene, scene.x0, x1);
      expect_same(found(scene, scene.x0, x1), expected);
      n_pairs[0] += expected.point_triangle.size();
      n_pairs[1] += expected.edge_edge.size();
      n_pairs[2] += expected.obstacle.size();
      n_pairs[3] += expected.obstacle_edge.size();
      n_pairs[4] += expected.obstacle_triangle.size();
    }
  };
  for (unsigned seed = 1; seed <= 60; ++seed) {
    expect_that_of_the_cpu_path(soup_scene(seed, 8 + static_cast<int>(seed)), seed);
  }
  // few triangles of a soup are near its ball and its bar
  for (unsigned seed = 1; seed <= 90; ++seed) expect_that_of_the_cpu_path(around_obstacles(seed), seed);
  for (const std::size_t n : n_pairs) EXPECT_GT(n, 5000U);
}

/// Boxes of the parents of leaves: how long their diagonals are, sorted.
std::vector<double> parents_of(const exec::TreeView& tree) {
  std::vector<double> out;
  for (Index i = 0; i < tree.size(1); ++i) {
    const exec::TreeNode node = tree.node(1, i);
    double sq = 0;
    for (int c = 0; c < 3; ++c) sq += std::pow(static_cast<double>(node.hi[c] - node.lo[c]), 2);
    out.push_back(std::sqrt(sq));
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// The vertices of all bodies in a random order, so that only the curve puts neighbours together.
FarScene shuffled_sheets(const FarBodies& far) {
  FarScene scene = sheets_and_far(24, 1e-3, far);
  std::mt19937_64 rng(1);
  std::shuffle(scene.scene.surface_triangles.begin(), scene.scene.surface_triangles.end(), rng);
  return scene;
}

TEST(ExecutorBroadPhase, FindsWhatTheCpuPathFindsBesideFarBodies) {
  double alone = 0;
  std::vector<FarBodies> cases = far_cases();
  cases.insert(cases.begin(), FarBodies{});
  for (const FarBodies& bodies : cases) {
    const FarScene far = shuffled_sheets(bodies);
    test::TestedExecutor executor;
    ExecutorMotion motion(executor, far.scene, far.scene.x0, far.x1);
    motion.update();
    const Candidates expected = cpu_candidates(far.scene, far.scene.x0, far.x1);
    EXPECT_GT(expect_same(lists_of(motion.candidates), expected), 5000U);
    const std::vector<double> parents = parents_of(motion.broad_phase.source().point_triangle.second);
    const double most = parents[parents.size() * 8 / 10];
    if (bodies.n == 1 && alone == 0) alone = most;
    EXPECT_LE(most, 1.2 * alone) << bodies.n << " bodies " << bodies.distance << " m away";
  }
  EXPECT_LT(alone, 0.3);
}

TEST(ExecutorBroadPhase, FindsThePairsOfLoneEdgesOfTheCpuPath) {
  std::size_t n_pairs = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const Scene scene = rods_and_sheet(seed, 0.04);
    for (const double size : {0.3, 1e-3}) {
      const Positions x1 = moved(scene, size, seed);
      const Candidates expected = cpu_candidates(scene, scene.x0, x1);
      expect_same(found(scene, scene.x0, x1), expected);
      n_pairs += expected.point_edge.size();
    }
  }
  EXPECT_GT(n_pairs, 1000U);
}

TEST(ExecutorBroadPhase, FindsThePlanarPairsOfTheCpuPath) {
  for (const PlanarPairs pairs : {PlanarPairs::vertex_vertex, PlanarPairs::point_edge}) {
    std::size_t n_pairs = 0, n_adjacent = 0;
    for (unsigned seed = 1; seed <= 20; ++seed) {
      const Scene scene = planar_scene(pairs, seed);
      for (const double size : {0.3, 1e-3}) {
        const Positions x1 = moved(scene, size, seed);
        const Candidates expected = cpu_candidates(scene, scene.x0, x1);
        n_pairs += expect_same(found(scene, scene.x0, x1), expected);
        const Surface s(scene);
        n_adjacent += s.connected_pairs().size() + s.opposite_corners().size();
      }
    }
    EXPECT_GT(n_pairs, 1500U);
    EXPECT_GT(n_adjacent, 1000U);
  }
}

/// All pairs of boxes, with a frame of the test's own.
template <PairKind K, int A, int B>
std::vector<IndexPair> brute_force(const exec::PairSearch& s, const exec::PrimitiveView<A>& a,
                                   const exec::PrimitiveView<B>& b, const exec::MotionView& motion) {
  std::vector<IndexPair> out;
  for (Index i = 0; i < a.n; ++i) {
    const auto p = primitive_box(a, i, motion);
    for (Index j = exec::one_tree<K> ? i + 1 : 0; j < b.n; ++j) {
      const auto q = primitive_box(b, j, motion);
      bool meet = a.free[i] != 0 || b.free[j] != 0;
      for (int c = 0; c < 3; ++c) meet = meet && p.lo[c] <= q.hi[c] && q.lo[c] <= p.hi[c];
      const float reach = float_above(contact_reach(a, i)) + float_above(contact_reach(b, j));
      meet = meet && !apart_by_boxes<float>(p.lo, p.hi, q.lo, q.hi, reach);
      if (meet && exec::may_pair<K>(s, i, j) && !exec::apart_by_rest_rule<K>(s, i, j))
        out.push_back({static_cast<int>(i), static_cast<int>(j)});
    }
  }
  return out;
}

exec::MotionFrame frame_of(const Surface& s, const Positions& x0, const Positions& x1) {
  exec::MotionFrame out{};
  std::vector<double> at_start[3];
  const auto n = static_cast<long long>(s.points.size());
  for (int c = 0; c < 3; ++c) {
    std::vector<double> way;
    for (int k = 0; k < n_sampled(n); ++k) {
      const int v = s.points.vertices[static_cast<std::size_t>(sampled(k, n))][0];
      at_start[c].push_back(x0(c, v));
      way.push_back(x1(c, v) - x0(c, v));
    }
    std::sort(at_start[c].begin(), at_start[c].end());
    std::sort(way.begin(), way.end());
    out.moved[c] = way[way.size() / 2];
  }
  out.folded = folded_frame([&](int c, int i) { return at_start[c][at(i)]; },
                            [&](int) { return n_sampled(n); }, s.element_size);
  return out;
}

TEST(ExecutorBroadPhase, FindsAllPairsOfBoxes) {
  std::size_t n_pairs = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const Scene scene = soup_scene(seed, 40);
    const Positions x1 = moved(scene, 0.1, seed);
    test::TestedExecutor executor;
    ExecutorMotion motion(executor, scene, scene.x0, x1);
    motion.update();
    const auto frame = frame_of(motion.surface, scene.x0, x1);
    const exec::MotionView view{motion.x0.data(), motion.x1.data(), &frame};
    const auto surface = motion.surface_there.view();
    const auto source = motion.broad_phase.source();
    const auto pt =
        brute_force<PairKind::point_triangle>(source.point_triangle, surface.points, surface.triangles, view);
    const auto ee = brute_force<PairKind::edge_edge>(source.edge_edge, surface.edges, surface.edges, view);
    EXPECT_EQ(pairs_of(motion.candidates.point_triangle), pt);
    EXPECT_EQ(pairs_of(motion.candidates.edge_edge), ee);
    n_pairs += pt.size() + ee.size();
  }
  EXPECT_GT(n_pairs, 5000U);
}

TEST(ExecutorBroadPhase, HoldsEveryClosePair) {
  struct Pointwise : Surface {
    using Surface::disjoint;
    using Surface::Surface;
    static bool disjoint(const std::array<int, 1>& p, const std::array<int, 3>& t) {
      return disjoint(p[0], t);
    }
  };
  std::size_t n_pt = 0, n_ee = 0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Scene scene = soup_scene(seed, 16);
    const Positions x1 = moved(scene, 0.2, seed);
    const Candidates c = found(scene, scene.x0, x1);
    const Pointwise s(scene);
    const auto held = [&]<PairKind K>(const auto& all, const auto& a, const auto& b) {
      std::size_t n = 0;
      for (std::size_t i = 0; i < a.size(); ++i) {
        for (std::size_t j = K == PairKind::edge_edge ? i + 1 : 0; j < b.size(); ++j) {
          const IndexPair index{static_cast<int>(i), static_cast<int>(j)};
          if ((!a.free[i] && !b.free[j]) || !Pointwise::disjoint(a.vertices[i], b.vertices[j])) continue;
          const ContactPair<K> pair = contact_pair<K>(s, index);
          bool close = false;
          for (const double t : {0.0, 0.35, 1.0}) {
            const Positions x = scene.x0 + t * (x1 - scene.x0);
            close = close || closest_points<K, double>(gather(x, pair.vertex)).d <=
                                 pair.law.offset + activation_distance<K>(s, pair.vertex.data(), pair.law);
          }
          if (!close) continue;
          EXPECT_TRUE(std::binary_search(all.begin(), all.end(), index));
          ++n;
        }
      }
      return n;
    };
    n_pt += held.template operator()<PairKind::point_triangle>(c.point_triangle, s.points, s.triangles);
    n_ee += held.template operator()<PairKind::edge_edge>(c.edge_edge, s.edges, s.edges);
  }
  EXPECT_GT(n_pt, 20U);
  EXPECT_GT(n_ee, 20U);
}

/// n free points in a row or all at one place, and a triangle among them.
Scene points_scene(int n, bool coincident) {
  Scene scene;
  std::vector<Vec3d> points;
  for (int i = 0; i < n; ++i) points.emplace_back(coincident ? 0.3 : 0.01 * i, 0.2, 0.005);
  add_body(scene, "points", points, {}, 0.02);
  add_body(scene, "triangle", {Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(0, 1, 0)}, {{0, 1, 2}}, 0.02, true);
  return scene;
}

TEST(ExecutorBroadPhase, WorksForEveryNumberOfPrimitivesAndForEqualCodes) {
  for (int n = 1; n <= 70; ++n) {
    for (const bool coincident : {false, true}) {
      const Scene scene = points_scene(n, coincident);
      const Candidates c = found(scene, scene.x0, scene.x0);
      EXPECT_EQ(expect_same(c, cpu_candidates(scene, scene.x0, scene.x0)), c.point_triangle.size());
      EXPECT_EQ(static_cast<int>(c.point_triangle.size()), n);
    }
  }
  Scene stack;  // all boxes equal: every edge meets every other one that it shares no vertex with
  for (int k = 0; k < 30; ++k) {
    add_body(stack, "t", {Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(0, 1, 0)}, {{0, 1, 2}}, 0.01);
  }
  const Candidates c = found(stack, stack.x0, stack.x0);
  expect_same(c, cpu_candidates(stack, stack.x0, stack.x0));
  EXPECT_EQ(c.point_triangle.size(), 30U * 29U * 3U);
  EXPECT_EQ(c.edge_edge.size(), 30U * 29U / 2U * 9U);
}

TEST(ExecutorBroadPhase, TakesOffTheMotionThatAllShare) {
  Scene scene = soup_scene(1, 60);
  scene.obstacles.clear();
  Positions x1 = scene.x0;
  x1.colwise() += Vec3d(50, -70, 20);
  const Candidates still = found(scene, scene.x0, scene.x0), falling = found(scene, scene.x0, x1);
  EXPECT_GT(expect_same(falling, cpu_candidates(scene, scene.x0, x1)), 100U);
  EXPECT_LT(falling.edge_edge.size(), 2 * still.edge_edge.size());
}

TEST(ExecutorBroadPhase, AgreesWhereNumbersAreNone) {
  const double inf = std::numeric_limits<double>::infinity(), none = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {inf, -inf, none, 1e39, -1e300}) {
    const Scene scene = soup_scene(5, 20);
    for (const int v : {0, 7, 60}) {
      for (const bool at_start : {false, true}) {
        Positions x0 = scene.x0, x1 = moved(scene, 0.1, 3);
        (at_start ? x0 : x1)(v % 3, v) = bad;
        EXPECT_GT(expect_same(found(scene, x0, x1), cpu_candidates(scene, x0, x1)), 50U);
      }
    }
  }
}

TEST(ExecutorBroadPhase, IsTheSameInAnyOrder) {
  const Scene scene = soup_scene(3, 150);
  const Positions x1 = moved(scene, 0.1, 5);
  const Candidates expected = cpu_candidates(scene, scene.x0, x1);
  for (const auto order :
       {exec::Order::threads, exec::Order::forward, exec::Order::reverse, exec::Order::shuffled}) {
    for (unsigned seed = 1; seed <= (order == exec::Order::shuffled ? 2 : 1); ++seed) {
      test::TestedExecutor executor(order, seed);
      ExecutorMotion motion(executor, scene, scene.x0, x1);
      motion.update();
      EXPECT_GT(expect_same(lists_of(motion.candidates), expected), 1000U);
    }
  }
}

TEST(ExecutorBroadPhase, FollowsTheSceneFromMotionToMotion) {
  const Scene scene = soup_scene(4, 50);
  test::TestedExecutor executor;
  ExecutorMotion motion(executor, scene, scene.x0, scene.x0);
  std::size_t most = 0, least = 1000000;
  for (const double size : {0.01, 1.0, 0.0, 0.2, 1e-6}) {
    const Positions x1 = moved(scene, size, 9);
    motion.move(scene.x0, x1);
    motion.update();
    const std::size_t n = expect_same(lists_of(motion.candidates), cpu_candidates(scene, scene.x0, x1));
    most = std::max(most, n);
    least = std::min(least, n);
  }
  EXPECT_GT(most, 3 * least);
  motion.broad_phase.update(motion.x0, motion.x0, motion.candidates);
  expect_same(lists_of(motion.candidates), cpu_candidates(scene, scene.x0, scene.x0));
}

TEST(ExecutorBroadPhase, CountsBeforeAnyListIsThere) {
  const Scene scene = soup_scene(2, 100);
  test::TestedExecutor executor;
  ExecutorMotion motion(executor, scene, scene.x0, moved(scene, 0.3, 1));
  const auto counts = motion.broad_phase.count(motion.x0, motion.x1, motion.candidates);
  EXPECT_EQ(motion.candidates.edge_edge.size(), 0);
  EXPECT_GT(counts.edge_edge, 1000);
  executor.limit_memory(executor.memory().bytes() + counts.bytes() / 2);
  try {
    motion.broad_phase.fill(motion.candidates);
    FAIL() << "there was enough memory";
  } catch (const exec::OutOfMemory& error) {
    EXPECT_NE(std::string(error.what()).find("candidates "), std::string::npos) << error.what();
  }
  executor.limit_memory(0);
  motion.broad_phase.fill(motion.candidates);
  EXPECT_EQ(motion.candidates.edge_edge.size(), counts.edge_edge);
  EXPECT_EQ(motion.candidates.point_triangle.size(), counts.point_triangle);
  EXPECT_EQ(motion.candidates.obstacle.size(), counts.obstacle);
}

TEST(ExecutorBroadPhase, NeedsTheMemoryThatACountForetells) {
  const Scene scene = soup_scene(1, 80);
  const Positions x1 = moved(scene, 0.1, 2);
  test::TestedExecutor executor;
  ExecutorMotion motion(executor, scene, scene.x0, x1);
  motion.update();
  const Candidates lists = lists_of(motion.candidates);
  const auto length = [](const auto& list) { return static_cast<Index>(list.size()); };
  exec::CountingExecutor counting;
  ExecutorMotion counted(counting, scene, scene.x0, x1);
  counted.broad_phase.expect({0, 0, length(lists.point_triangle), length(lists.edge_edge),
                              length(lists.obstacle), length(lists.obstacle_edge),
                              length(lists.obstacle_triangle)});
  counted.update();
  EXPECT_EQ(counting.memory().by_name(), executor.memory().by_name());
  EXPECT_GT(counting.memory().by_name().at("tree of edges"), 42U * motion.surface.edges.size());
}

}  // namespace
}  // namespace bb::test::executor_broad_phase_test
