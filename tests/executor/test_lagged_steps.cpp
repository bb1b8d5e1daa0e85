// What rows on lagged contacts keep from step to step, and what is found of them once a step: speeds at which pairs met, sides, turns of
// obstacles.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "tests/executor/lagged_fixture.hpp"

namespace bb::lagged_rows_test {
namespace {

// Pairs that were there keep the speed at which they met; the others meet with that of the step before.
TEST(LaggedRows, RememberHowFastPairsMet) {
  const Scene scene = with_restitution(full_scene(3));
  const Positions x = shaken(scene), end = random_motion(x, 5e-3, 7);
  TestedExecutor executor;
  OnRows on = restitution_on(executor, scene, x, dt);
  LaggedState some = on.family->known("restitution");
  const std::vector<PairId> all = some.pair;
  const std::vector<double> first = some.kept;
  some.pair.clear(), some.kept.clear();
  for (std::size_t r = 0; r < all.size(); r += 3)
    some.pair.push_back(all[r]), some.kept.push_back(7 + static_cast<double>(r));
  const std::size_t n = some.pair.size();
  some.vertex.assign(4 * n, 0), some.weight.assign(4 * n, 0), some.normal.assign(3 * n, 0);
  some.load.assign(n, 0), some.strength.assign(n, 0);
  on.family->adopt(some);
  upload(on.y, end);
  on.family->end_step(on.y.data());
  on.take();
  const LaggedState found = on.family->known("restitution");
  const HostLaggedState host(scene, x, restitution_sides(scene));
  ASSERT_EQ(found.pair, all);
  std::map<PairId, std::size_t> row;
  for (std::size_t r = 0; r < all.size(); ++r) row[host.contacts.pair[r]] = r;
  double largest = 0, apart = 0;
  for (std::size_t r = 0; r < all.size(); ++r) {
    const std::size_t of_host = row.at(all[r]);
    const double closing = -host.relative(of_host, (end - x) / dt).dot(host.normal(of_host));
    const double expected = r % 3 == 0 ? 7 + static_cast<double>(r) : closing;
    largest = std::max(largest, std::abs(closing));
    apart = std::max(apart, std::abs(first[r] - closing));
    EXPECT_NEAR(found.kept[r], expected, 1e-12);
    EXPECT_NEAR(found.strength[r], host.strength[of_host] / std::max(expected, 0.01),
                1e-12 * host.strength[of_host]);
  }
  ASSERT_GT(largest, 0.1);
  ASSERT_GT(apart, 0.1);
}

// An archive from before the first step takes the speeds of a later one back.
TEST(LaggedRows, MeetWithTheSpeedsOfTheSceneWhereAnArchiveHasNone) {
  const Scene scene = with_restitution(full_scene(3));
  const Positions x = shaken(scene), end = random_motion(x, 5e-3, 7);
  TestedExecutor executor;
  OnRows on = restitution_on(executor, scene, x, dt);
  const std::vector<double> first = on.family->known("restitution").kept;
  Archive none;
  restitution_on(executor, scene, x, dt).family->keep(none);
  upload(on.y, end);
  on.family->end_step(on.y.data());
  Archive again(none.bytes());
  on.family->keep(again);
  LaggedState nobody = on.family->known("restitution");
  for (PairId& pair : nobody.pair) pair = 0;  // so that all pairs are new
  on.family->adopt(nobody);
  on.take();
  EXPECT_EQ(on.family->known("restitution").kept, first);
  ASSERT_GT(*std::max_element(first.begin(), first.end()), 0.1);
}

// The sides of two edges of which one counts with an end alone are two bodies, whatever obstacles there are.
TEST(LaggedRows, TakeAnEndOfAnEdgeForNoObstacle) {
  const double of_body[] = {0.2, 0.5}, of_obstacle[] = {7};
  const int body[] = {0, 0, 1, 1}, vertex[] = {0, 1, 2, 3};
  const SideCoefficients sides{of_body, of_obstacle, body, CombineRule::max};
  EXPECT_EQ(sides.of(vertex, 1, pair_id(0, 0, 0)), 0.5);
  EXPECT_EQ(sides.of(vertex, 1, pair_id(end_pairs, 0, 0)), 0.5);
  EXPECT_EQ(sides.of(vertex, 1, pair_id(obstacle_pairs, 0, 0)), 7);
}

/// Every obstacle stands at a prescribed vertex of its own.
Scene with_vertices_of_obstacles(Scene scene) {
  for (Obstacle& o : scene.obstacles) {
    o.vertex = scene.n_vertices();
    scene.rest.conservativeResize(3, o.vertex + 1);
    scene.rest.col(o.vertex) = o.point;
    scene.mass.push_back(0);
    scene.body.push_back(0);
    scene.d_hat.push_back(0.08);
    scene.offset.push_back(0);
    scene.pins.push_back({o.vertex, 0});
  }
  scene.x0 = scene.rest;
  return scene;
}

Mat3d turned(double angle) { return Eigen::AngleAxisd(angle, Vec3d(2, 1, -2) / 3.0).toRotationMatrix(); }

// What the turn of an obstacle takes along is where its surface is nearest: the gap away from the other side, along the normal.
TEST(LaggedRows, FollowTheSurfaceOfObstaclesThatTurn) {
  const Scene scene = with_vertices_of_obstacles(full_scene(3));
  const Positions x = shaken(scene);
  TestedExecutor executor;
  const FrictionOptions options = friction_options("capped", CombineRule::max);
  OnRows on = friction_on(executor, scene, x, options);
  std::vector<ObstacleTurn> turns;
  for (std::size_t o = 0; o < scene.obstacles.size(); ++o) {
    ObstacleTurn& turn = turns.emplace_back();
    turn.kind = scene.obstacles[o].kind;
    turn.radius = scene.obstacles[o].radius;
    Vec3d::Map(turn.axis) = scene.obstacles[o].axis;
    turn.turns = o != 2;
    Mat3d::Map(turn.lagged) = turned(0.1 + static_cast<double>(o));
    Mat3d::Map(turn.begin) = turned(0.3);
    Mat3d::Map(turn.end) = turned(0.7);
  }
  exec::Buffer<ObstacleTurn> there(executor, "turns");
  there.upload(turns);
  const Index n = on.family->size();
  exec::Buffer<double> spin(executor, "spin", 3 * n);
  LaggedColumns& columns = on.family->rows();
  const LaggedRows view{n,       columns.vertex.data(), columns.weight.data(), columns.normal.data(), nullptr,
                        nullptr, on.x_n.data()};
  executor.each(n, FindSpins{view, columns.pair.data(), there.data(), on.x_n.data(), spin.data()});
  const std::vector<double> found = spin.download();
  const exec::RowView rows = on.on.rows.view();
  std::vector<int> seen(scene.obstacles.size(), 0);
  for (Index r = 0; r < n; ++r) {
    const Vec3d way(found[at(static_cast<int>(r))], found[at(static_cast<int>(n + r))],
                    found[at(static_cast<int>(2 * n + r))]);
    const int o = pair_obstacle(rows.pair[r]);
    if (o < 0 || o == 2) {
      EXPECT_EQ(way, Vec3d(0, 0, 0));
      continue;
    }
    if (scene.body[at(rows.vertex[r])] == 1 || rows.mollified(r)) continue;  // with a thickness
    Vec3d side = Vec3d::Zero();
    for (int k = 0; k < 4; ++k) {
      const int v = rows.vertex[k * n + r];
      if (v >= 0 && v != scene.obstacles[at(o)].vertex) side += rows.weight[k * n + r] * x.col(v);
    }
    const Vec3d arm = side - rows.d[r] * rows.normal_of(r) - x.col(scene.obstacles[at(o)].vertex);
    const Mat3d back = turned(-0.1 - o);
    const Vec3d expected = (turned(0.7) - turned(0.3)) * (back * arm);
    EXPECT_LT((way - expected).norm(), 1e-12 * (1 + arm.norm()));
    seen[at(o)] += way.norm() > 1e-3;
  }
  for (const std::size_t o : {1, 3, 4}) EXPECT_GT(seen[o], 0) << o;
}

}  // namespace
}  // namespace bb::lagged_rows_test
