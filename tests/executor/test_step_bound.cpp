// The step bound on an executor: alpha and pair of the CPU path to the bit, known times, any order, any batches.
#include <gtest/gtest.h>

#include <filesystem>

#include "core/model/mesh/read_mesh.hpp"
#include "tests/contact/far_bodies.hpp"
#include "tests/contact/obstacle_scenes.hpp"
#include "tests/contact/rods.hpp"
#include "tests/executor/both_bounds.hpp"
#include "tests/executor/tested_executor.hpp"
#include "tests/optional_data.hpp"

namespace bb::test::executor_step_bound_test {
namespace {

TEST(ExecutorStepBound, IsThatOfTheCpuPathOfRodsAndBesideFarBodies) {
  std::array<int, 8> n_of_kind{};
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const Scene scene = rods_and_sheet(seed, 0.02);
    for (const double size : {0.1, 1e-2}) {
      expect_that_of_the_cpu_path(scene, moved(scene, size, seed), n_of_kind);
    }
  }
  EXPECT_GT(n_of_kind[static_cast<std::size_t>(ContactKind::point_edge)], 0);
  for (const double sink : {1e-3, 0.02}) {
    test::TestedExecutor executor;
    const FarScene near = sheets_and_far(12, sink, {});
    ExecutorMotion alone(executor, near.scene, near.scene.x0, near.x1);
    const BothBounds expected = bounds(executor, alone);
    for (const FarBodies& bodies : far_cases()) {
      const FarScene far = sheets_and_far(12, sink, bodies);
      expect_that_of_the_cpu_path(far.scene, far.x1, n_of_kind);
      ExecutorMotion motion(executor, far.scene, far.scene.x0, far.x1);
      const BothBounds found = bounds(executor, motion);
      EXPECT_EQ(found.listed.alpha, expected.listed.alpha);
      EXPECT_LE(found.listed.queries, expected.listed.queries * 11 / 10 + 20);
    }
  }
  EXPECT_GT(n_of_kind[static_cast<std::size_t>(ContactKind::edge_edge)] +
                n_of_kind[static_cast<std::size_t>(ContactKind::point_triangle)],
            5);
}

/// What is about a ball or a bar shrinks onto it, so that nothing else is in the way.
Positions drawn_to(const Scene& scene, const Obstacle& to, double part) {
  Positions out = scene.x0;
  for (Eigen::Index v = 0; v < out.cols(); ++v) {
    Vec3d q = scene.x0.col(v) - to.point;
    if (q.norm() > 3) continue;
    if (to.kind == ObstacleKind::cylinder) q -= to.axis * to.axis.dot(q);
    out.col(v) -= part * q;
  }
  return out;
}

TEST(ExecutorStepBound, IsThatOfTheCpuPathInSoups) {
  std::array<int, 8> n_of_kind{};
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const Scene scene = soup_scene(seed, 5 + static_cast<int>(seed) / 2);
    for (const double size : {1.0, 0.1, 1e-2, 1e-4}) {
      expect_that_of_the_cpu_path(scene, moved(scene, size, seed), n_of_kind);
    }
  }
  // few triangles of a soup are near its ball and its bar, and others stop them before
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Scene scene = around_obstacles(seed);
    for (const Obstacle& to : scene.obstacles) {
      expect_that_of_the_cpu_path(scene, drawn_to(scene, to, 0.4), n_of_kind);
    }
  }
  for (const auto kind : {ContactKind::point_triangle, ContactKind::edge_edge, ContactKind::obstacle,
                          ContactKind::obstacle_edge, ContactKind::obstacle_triangle}) {
    EXPECT_GT(n_of_kind[static_cast<std::size_t>(kind)], 5);
  }
  EXPECT_GT(n_of_kind[7], 20);
}

TEST(ExecutorStepBound, IsThatOfTheCpuPathInThePlane) {
  std::array<int, 8> n_of_kind{};
  for (unsigned seed = 1; seed <= 20; ++seed) {
    for (const PlanarPairs pairs : {PlanarPairs::vertex_vertex, PlanarPairs::point_edge}) {
      Scene scene = planar_scene(pairs, seed);
      for (const double size : {0.5, 1e-2, 1e-4}) {
        expect_that_of_the_cpu_path(scene, moved(scene, size, seed), n_of_kind);
      }
    }
  }
  // edges of a random soup cross: their points, and points and edges, stop motions where none is in the way
  EXPECT_GT(n_of_kind[static_cast<std::size_t>(ContactKind::point_point)] +
                n_of_kind[static_cast<std::size_t>(ContactKind::point_edge)],
            20);
  EXPECT_GT(n_of_kind[static_cast<std::size_t>(ContactKind::point_edge)], 5);
}

Scene point_above_floor(double height) {
  Scene scene;
  const auto [vertices, triangles] = grid(2, 2, 1.0);
  add_body(scene, "floor", vertices, triangles, 0.01, true);
  add_body(scene, "point", {Vec3d(0.7, 0.4, height)}, {}, 0.01);
  return scene;
}

TEST(ExecutorStepBound, StopsAtTheKnownTime) {
  const Scene scene = point_above_floor(1);
  Positions x1 = scene.x0;
  x1(2, 9) = -1;
  const double exact = (1 - 1e-8) / 2;  // where the stop level, 1e-6 d_hat, is reached
  const BothBounds found = bounds(scene, x1);
  for (const StepBound& b : {found.listed, found.unlisted}) {
    EXPECT_LE(b.alpha, exact);
    EXPECT_NEAR(b.alpha, exact, 1e-12);
    EXPECT_EQ(b.kind, ContactKind::point_triangle);
    EXPECT_EQ(b.key[3], 9);
    EXPECT_GE(b.queries, 1);
  }
  x1(2, 9) = 0.9;
  EXPECT_EQ(bounds(scene, x1).listed.alpha, 1);
  EXPECT_EQ(bounds(scene, x1).listed.key, (ContactKey{-1, -1, -1, -1}));
}

TEST(ExecutorStepBound, CountsPairsThatTouch) {
  const Scene scene = point_above_floor(0);
  Positions x1 = scene.x0;
  x1(2, 9) = -1;
  const BothBounds found = bounds(scene, x1);
  EXPECT_EQ(found.listed.alpha, 0);
  EXPECT_GE(found.listed.zero, 1);
  EXPECT_EQ(found.unlisted.zero, found.listed.zero);
}

/// Many pairs that stop the motion at the very same time: the first of the lists is named, whatever the batches.
TEST(ExecutorStepBound, NamesTheFirstOfPairsThatLimitAlike) {
  Scene scene;
  for (int k = 0; k < 40; ++k) {
    const double x = 4 * k;
    add_body(scene, "floor", {Vec3d(x, 0, 0), Vec3d(x + 2, 0, 0), Vec3d(x, 2, 0)}, {{0, 1, 2}}, 0.01, true);
    add_body(scene, "point", {Vec3d(x + 0.5, 0.5, 1)}, {}, 0.01);
  }
  scene.obstacles = {obstacle(ObstacleKind::plane, Vec3d(0, 0, -5), 0)};
  Positions x1 = scene.x0;
  for (int v = 3; v < x1.cols(); v += 4) x1(2, v) = -1;
  const StepBound expected = cpu_bound(scene, cpu_candidates(scene, scene.x0, x1), scene.x0, x1);
  EXPECT_NEAR(expected.alpha, 0.5, 1e-6);
  for (const exec::Index length : {1, 2, 7, 64}) {
    const BothBounds found = bounds(scene, x1, {3 * length, length, 2 * length});
    expect_same(found.listed, expected);
    expect_same(found.unlisted, expected);
  }
}

TEST(ExecutorStepBound, AlphaAndPairDoNotDependOnBatches) {
  int bounded = 0;
  long long fewest = 1000000, most = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Scene scene = soup_scene(seed, 25);
    const Positions x1 = moved(scene, 0.1, seed);
    const StepBound expected = cpu_bound(scene, cpu_candidates(scene, scene.x0, x1), scene.x0, x1);
    bounded += expected.alpha < 1;
    for (const BoundBatches batches :
         {BoundBatches{1, 1, 1}, BoundBatches{50, 3, 9}, BoundBatches{1000, 1000, 1000}}) {
      const BothBounds found = bounds(scene, x1, batches);
      expect_same(found.listed, expected);
      expect_same(found.unlisted, expected);
      fewest = std::min(fewest, found.listed.queries);
      most = std::max(most, found.listed.queries);
    }
  }
  EXPECT_GE(bounded, 4);
  EXPECT_GT(most, 2 * fewest);
}

TEST(ExecutorStepBound, IsTheSameInAnyOrderWithItsCounters) {
  const Scene scene = soup_scene(3, 120);
  const Positions x1 = moved(scene, 0.03, 5);
  std::vector<BothBounds> found;
  for (const auto order :
       {exec::Order::threads, exec::Order::forward, exec::Order::reverse, exec::Order::shuffled}) {
    for (unsigned seed = 1; seed <= (order == exec::Order::shuffled ? 2 : 1); ++seed) {
      test::TestedExecutor executor(order, seed);
      ExecutorMotion motion(executor, scene, scene.x0, x1);
      found.push_back(bounds(executor, motion, {512, 16, 128}));
    }
  }
  ASSERT_EQ(found.size(), 5U);
  for (const BothBounds& b : found) {
    for (const auto side : {&BothBounds::listed, &BothBounds::unlisted}) {
      expect_same(b.*side, found[0].*side);
      EXPECT_EQ((b.*side).queries, (found[0].*side).queries);
      EXPECT_EQ((b.*side).probes, (found[0].*side).probes);
    }
  }
  EXPECT_LT(found[0].listed.alpha, 1);
  EXPECT_GT(found[0].listed.queries, 5);
}

TEST(ExecutorStepBound, AMotionThatIsNotFiniteIsNoStep) {
  const Scene scene = soup_scene(1, 10);
  for (const double bad : {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
                           std::numeric_limits<double>::quiet_NaN()}) {
    Positions x1 = scene.x0;
    x1(1, 4) = bad;
    const BothBounds found = bounds(scene, x1);
    EXPECT_EQ(found.listed.alpha, 0);
    EXPECT_EQ(found.unlisted.alpha, 0);
    EXPECT_EQ(found.listed.key, (ContactKey{-1, -1, -1, -1}));
  }
}

/// Bodies of a given scene that slide along each other: few pairs are queried.
TEST(ExecutorStepBound, AsksFewPairsOfSheetsThatSlide) {
  Scene scene;
  const auto [v1, t1] = grid(12, 12, 0.1);
  const auto [v2, t2] = grid(12, 12, 0.1, Vec3d(0.03, 0.02, 1e-4));
  add_body(scene, "floor", v1, t1, 0.01, true);
  add_body(scene, "cloth", v2, t2, 0.01);
  Positions x1 = scene.x0;
  x1.rightCols(169).colwise() += Vec3d(0.25, 0.1, 0);
  const BothBounds found = bounds(scene, x1);
  const Candidates candidates = cpu_candidates(scene, scene.x0, x1);
  const std::size_t n = candidates.point_triangle.size() + candidates.edge_edge.size();
  EXPECT_EQ(found.listed.alpha, 1);
  EXPECT_GT(n, 10000U);
  EXPECT_LT(50 * static_cast<std::size_t>(found.listed.queries), n);
  EXPECT_LT(50 * static_cast<std::size_t>(found.unlisted.queries), n);
}

TEST(ExecutorStepBound, IsThatOfTheCpuPathBetweenTwoFramesOfACloth) {
  const std::filesystem::path meshes = optional_data("meshes");
  if (!std::filesystem::exists(meshes / "cloth_ball92.ply"))
    GTEST_SKIP() << "no cloth_ball92.ply in " << meshes;
  const TriangleMesh before = read_mesh(meshes / "cloth_ball92.ply"),
                     after = read_mesh(meshes / "cloth_ball93.ply");
  Scene scene;
  std::vector<Vec3d> vertices;
  for (Eigen::Index i = 0; i < before.vertices.cols(); ++i) vertices.push_back(before.vertices.col(i));
  add_body(scene, "cloth and ball", vertices, before.triangles, 1e-3);
  const Positions x1 = after.vertices;
  ASSERT_EQ(x1.cols(), scene.x0.cols());
  const Candidates expected = cpu_candidates(scene, scene.x0, x1);
  test::TestedExecutor executor;
  ExecutorMotion motion(executor, scene, scene.x0, x1);
  const BothBounds found = bounds(executor, motion);
  EXPECT_EQ(pairs_of(motion.candidates.point_triangle), expected.point_triangle);
  EXPECT_EQ(pairs_of(motion.candidates.edge_edge), expected.edge_edge);
  EXPECT_GT(expected.edge_edge.size(), 100000U);
  const StepBound bound = cpu_bound(scene, expected, scene.x0, x1);
  expect_same(found.listed, bound);
  expect_same(found.unlisted, bound);
  EXPECT_LT(bound.alpha, 1);
  RecordProperty("alpha", std::to_string(bound.alpha));
  RecordProperty("queries", static_cast<int>(found.listed.queries));
}

}  // namespace
}  // namespace bb::test::executor_step_bound_test
