// Feasibility of states, the check at scene load, names, and the memory of stiffness.
#include <gtest/gtest.h>

#include "tests/contact/contact_scenes.hpp"

namespace bb::test {
namespace {

Scene cloth_and_ball(double height) {
  Scene scene;
  const auto [vertices, triangles] = grid(2, 2, 1.0);
  add_body(scene, "cloth", vertices, triangles, 0.1);
  add_body(scene, "tip", {Vec3d(0.7, 0.4, height), Vec3d(0.7, 0.5, 1 + height), Vec3d(0.8, 0.4, 1 + height)},
           {{0, 1, 2}}, 0.1, true);
  return scene;
}

TEST(Feasibility, HoldsExactlyWhileEveryGapIsPositive) {
  const Scene scene = cloth_and_ball(0.05);
  ContactSystem contacts(scene, {});
  Positions touching = scene.x0;
  touching.rightCols(3).row(2).array() -= 0.05;
  contacts.update_candidates(scene.x0, touching);
  EXPECT_TRUE(contacts.feasible(scene.x0));
  EXPECT_FALSE(contacts.feasible(touching));

  Positions broken = scene.x0;
  broken(0, 4) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(contacts.feasible(broken));
  ContactTable rows;
  MollifiedTable mollified;
  EXPECT_LE(contacts.find_rows(broken, rows, mollified), 0);
}

TEST(InitialCheck, NamesTheFirstPairThatTouches) {
  const Scene apart = cloth_and_ball(0.05);
  ContactSystem fine(apart, {});
  EXPECT_FALSE(fine.check_initial(apart.x0).has_value());

  Scene thick = apart;
  thick.offset.assign(thick.offset.size(), 0.03);
  ContactSystem overlapping(thick, {});
  const auto found = overlapping.check_initial(thick.x0);
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->gap, -0.01, 1e-15);
  EXPECT_EQ(found->kind, ContactKind::point_triangle);
  EXPECT_EQ(found->text, "point_triangle: cloth[0], cloth[1], cloth[4], tip[0]");
}

TEST(InitialCheck, SeesObstaclesAndDescribesThemByName) {
  Scene scene = cloth_and_ball(0.05);
  Obstacle floor;
  floor.name = "floor";
  floor.point = Vec3d(0, 0, 1e-3);
  scene.obstacles.push_back(floor);
  ContactSystem contacts(scene, {});
  const auto found = contacts.check_initial(scene.x0);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->text, "obstacle: floor, cloth[0]");
  EXPECT_NEAR(found->gap, -1e-3, 1e-15);
}

/// Tables of a state with kappa = 1, 2, 3, ... in row order.
Rows numbered(ContactSystem& contacts, const Positions& x) {
  Rows rows = rows_at(contacts, x);
  for (std::size_t r = 0; r < rows.table.size(); ++r) rows.table.kappa[r] = static_cast<double>(r + 1);
  for (std::size_t r = 0; r < rows.mollified.size(); ++r) {
    rows.mollified.kappa[r] = 1000 + static_cast<double>(r);
  }
  return rows;
}

Scene two_sheets() {
  Scene scene;
  const auto [v1, t1] = grid(3, 3, 0.3);
  const auto [v2, t2] = grid(3, 3, 0.31, Vec3d(0.013, 0.027, 0.06));
  add_body(scene, "low", v1, t1, 0.1);
  add_body(scene, "high", v2, t2, 0.1);
  return scene;
}

TEST(KappaMemory, GivesBackWhatItStoredAndReportsTheRest) {
  const Scene scene = two_sheets();
  ContactSystem contacts(scene, {});
  const Rows stored = numbered(contacts, scene.x0);
  ASSERT_GT(stored.table.size(), 10U);
  ASSERT_GT(stored.mollified.size(), 0U);
  KappaMemory memory;
  memory.store(stored.table, stored.mollified);

  Rows same = rows_at(contacts, scene.x0);
  std::vector<int> missing{7}, missing_mollified{7};
  memory.recall(same.table, same.mollified, missing, missing_mollified);
  EXPECT_TRUE(missing.empty() && missing_mollified.empty());
  EXPECT_EQ(same.table.kappa, stored.table.kappa);
  EXPECT_EQ(same.mollified.kappa, stored.mollified.kappa);

  Positions moved = scene.x0;
  moved.rightCols(16).colwise() += Vec3d(0.1, 0.05, 0);
  Rows other = rows_at(contacts, moved);
  memory.recall(other.table, other.mollified, missing, missing_mollified);
  EXPECT_GT(missing.size(), 0U);
  std::size_t known = 0, next = 0;
  for (std::size_t r = 0; r < other.table.size(); ++r) {
    if (next < missing.size() && missing[next] == static_cast<int>(r)) {
      ++next;
      EXPECT_EQ(other.table.kappa[r], 0);
      EXPECT_LT(find_row(stored.table, other.table.key[r], other.table.kind[r]), 0);
      continue;
    }
    ++known;
    const int row = find_row(stored.table, other.table.key[r], other.table.kind[r]);
    ASSERT_GE(row, 0);
    EXPECT_EQ(other.table.kappa[r], stored.table.kappa[at(row)]);
  }
  EXPECT_GT(known, 0U);
}

TEST(KappaMemory, KnownRowsKeepTheirFirstValueUntilCleared) {
  const Scene scene = two_sheets();
  ContactSystem contacts(scene, {});
  Rows rows = numbered(contacts, scene.x0);
  KappaMemory memory;
  memory.store(rows.table, rows.mollified);
  memory.store({}, {});  // a state without contacts does not make it forget
  const std::vector<double> first = rows.table.kappa;
  for (double& k : rows.table.kappa) k += 100;
  memory.store(rows.table, rows.mollified);
  std::vector<int> missing, missing_mollified;
  memory.recall(rows.table, rows.mollified, missing, missing_mollified);
  EXPECT_EQ(rows.table.kappa, first);

  memory.clear();
  memory.recall(rows.table, rows.mollified, missing, missing_mollified);
  EXPECT_EQ(missing.size(), rows.table.size());
  EXPECT_EQ(missing_mollified.size(), rows.mollified.size());
}

TEST(KappaMemory, AnEdgePairKeepsItsValueWhenItBecomesMollified) {
  Scene scene;
  add_body(scene, "a", {Vec3d(0, 0, 0), Vec3d(1, 0, 0)}, {}, 0.2);
  add_body(scene, "b", {Vec3d(0.1, -0.1, 0.1), Vec3d(1.1, 0.09, 0.11)}, {}, 0.2);
  scene.surface_edges = {{0, 1}, {2, 3}};
  ContactSystem contacts(scene, {});
  Rows plain = rows_at(contacts, scene.x0);
  ASSERT_EQ(plain.table.size(), 1U);
  plain.table.kappa[0] = 42;
  KappaMemory memory;
  memory.store(plain.table, plain.mollified);

  Positions turned = scene.x0;
  turned(1, 2) = -0.01;
  turned(1, 3) = 0.009;
  Rows parallel = rows_at(contacts, turned);
  ASSERT_EQ(parallel.mollified.size(), 1U);
  std::vector<int> missing, missing_mollified;
  memory.recall(parallel.table, parallel.mollified, missing, missing_mollified);
  EXPECT_EQ(parallel.mollified.kappa[0], 42);
  EXPECT_TRUE(missing_mollified.empty());
}

}  // namespace
}  // namespace bb::test
