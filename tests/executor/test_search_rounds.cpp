// The search in rounds: where a leaf meets more than it has places for, its walk goes on in the next round, and no part of a
// tree is walked twice once the lists are large enough.
#include <gtest/gtest.h>

#include "core/exec/metered_executor.hpp"
#include "tests/executor/contact_motion.hpp"
#include "tests/executor/tested_executor.hpp"

namespace bb::test::search_rounds_test {
namespace {

using exec::Index;

constexpr int places = 16;

/// n triangles on top of each other: every leaf meets all others.
Scene stack_of(int n) {
  Scene stack;
  for (int k = 0; k < n; ++k) {
    add_body(stack, "t", {Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(0, 1, 0)}, {{0, 1, 2}}, 0.01);
  }
  return stack;
}

/// Triangles among more obstacles than a primitive has places for.
Scene among_spheres(int n_spheres) {
  Scene scene = stack_of(3);
  for (int k = 0; k < n_spheres; ++k) {
    const Vec3d centre(0.1 * k, 0.3, k % 3 == 0 ? 5 : 0.3);  // every third one is out of reach
    scene.obstacles.push_back(obstacle(ObstacleKind::sphere, centre, 0.2));
  }
  return scene;
}

std::size_t expect_lists_of_the_host(exec::Executor& executor, const Scene& scene, int& rounds) {
  ExecutorMotion motion(executor, scene, scene.x0, scene.x0);
  motion.broad_phase.hold(places);
  const Candidates expected = cpu_candidates(scene, scene.x0, scene.x0);
  for (int time = 0; time < 2; ++time) {  // the second time the lists are large enough
    motion.update();
    const Candidates found = lists_of(motion.candidates);
    EXPECT_EQ(found.point_triangle, expected.point_triangle);
    EXPECT_EQ(found.edge_edge, expected.edge_edge);
    EXPECT_EQ(found.obstacle, expected.obstacle);
    EXPECT_EQ(found.obstacle_edge, expected.obstacle_edge);
    EXPECT_EQ(found.obstacle_triangle, expected.obstacle_triangle);
  }
  rounds = motion.broad_phase.rounds();
  return expected.point_triangle.size() + expected.edge_edge.size() + expected.obstacle.size() +
         expected.obstacle_edge.size() + expected.obstacle_triangle.size();
}

TEST(SearchRounds, GoOnWhereThePlacesOfALeafAreFull) {
  for (const auto order :
       {exec::Order::threads, exec::Order::forward, exec::Order::reverse, exec::Order::shuffled}) {
    test::TestedExecutor executor(order, 3);
    int rounds = 0;
    EXPECT_EQ(expect_lists_of_the_host(executor, stack_of(20), rounds), 20U * 19U * 3U + 20U * 19U / 2U * 9U);
    EXPECT_EQ(rounds, 4);  // the first edge of the tree meets 59 others
  }
}

TEST(SearchRounds, AreAsManyForAnyNumberOfPlaces) {
  const Scene scene = stack_of(12);  // the first edge of the tree meets 35 others
  const Candidates expected = cpu_candidates(scene, scene.x0, scene.x0);
  ASSERT_EQ(expected.edge_edge.size(), 12U * 11U / 2U * 9U);
  for (const int held : {1, 17, 34, 35, 36, 64, 255}) {
    test::TestedExecutor executor;
    ExecutorMotion motion(executor, scene, scene.x0, scene.x0);
    motion.broad_phase.hold(held);
    motion.update();
    EXPECT_EQ(lists_of(motion.candidates).edge_edge, expected.edge_edge) << held;
    EXPECT_EQ(lists_of(motion.candidates).point_triangle, expected.point_triangle) << held;
    EXPECT_GE(motion.broad_phase.rounds() * held, 35) << held;
    EXPECT_LE((motion.broad_phase.rounds() - 2) * held, 35) << held;
  }
  EXPECT_EQ(exec::places_of_an_item(1000), 64);
  EXPECT_EQ(exec::places_of_an_item(2000000), 33);
  EXPECT_EQ(exec::places_of_an_item(33000000), 16);
}

// Rounds that walks need and no obstacle.
TEST(SearchRounds, AreAsManyAsWalksAndObstaclesNeed) {
  Scene scene = stack_of(20);
  scene.obstacles = among_spheres(3).obstacles;
  test::TestedExecutor executor;
  int rounds = 0;
  EXPECT_GT(expect_lists_of_the_host(executor, scene, rounds), 20U * 19U * 3U + 20U * 19U / 2U * 9U);
  EXPECT_EQ(rounds, 4);
}

TEST(SearchRounds, AskAboutMoreObstaclesThanThereArePlaces) {
  for (const int n : {places, places + 1, 2 * places + 3}) {
    test::TestedExecutor executor;
    int rounds = 0;
    EXPECT_GT(expect_lists_of_the_host(executor, among_spheres(n), rounds), 50U);
    EXPECT_EQ(rounds, (n + places - 1) / places) << n;
  }
}

/// Launches of the walk in one update.
Index walks(exec::MeteredExecutor& executor, ExecutorMotion& motion) {
  executor.clear();
  motion.update();
  return executor.counts().by_kernel.at("bb::exec::WalkTrees").launches;
}

TEST(SearchRounds, WalkNoPartOfATreeTwice) {
  exec::MeteredExecutor executor;
  const Scene few = stack_of(3), many = stack_of(20);
  ExecutorMotion once(executor, few, few.x0, few.x0);
  EXPECT_EQ(walks(executor, once), 1);  // also where the lists were too short
  EXPECT_EQ(walks(executor, once), 1);
  ExecutorMotion rounds(executor, many, many.x0, many.x0);
  rounds.broad_phase.hold(places);
  EXPECT_EQ(walks(executor, rounds), 8);  // once to count: of several rounds the first pairs are gone
  EXPECT_EQ(walks(executor, rounds), 4);
  rounds.candidates.free();  // as where memory is short
  rounds.broad_phase.count(rounds.x0, rounds.x1, rounds.candidates, std::size_t{1} << 30);
  executor.clear();
  rounds.broad_phase.fill(rounds.candidates);
  EXPECT_FALSE(executor.counts().by_kernel.contains("bb::exec::WalkTrees"));
  EXPECT_EQ(rounds.candidates.edge_edge.size(), 20 * 19 / 2 * 9);
}

}  // namespace
}  // namespace bb::test::search_rounds_test
