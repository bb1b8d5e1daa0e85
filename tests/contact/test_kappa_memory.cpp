// A row that continues a contact on a neighbouring feature keeps its stiffness, so that B does
// not jump there.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "tests/contact/contact_scenes.hpp"

namespace bb::test::kappa_memory_test {
namespace {

// A point (vertex 0) above two triangles that share the edge x = 0.
Scene point_over_fan() {
  Scene scene;
  add_body(scene, "point", {Vec3d(0, 0, 0.05)}, {}, 0.1);
  scene.surface_vertices = {0};
  add_body(scene, "fan", {Vec3d(0, -1, 0), Vec3d(0, 1, 0), Vec3d(-1, 0, 0), Vec3d(1, 0, 0)},
           {{0, 1, 2}, {0, 3, 1}}, 0.1);
  return scene;
}

Rows at(ContactSystem& contacts, const Scene& scene, double x) {
  Positions moved = scene.x0;
  moved(0, 0) = x;
  return rows_at(contacts, moved);
}

// B with the quadratic (d_hat - d)^2.
double barrier_energy(const Rows& rows) {
  double energy = 0;
  for (std::size_t r = 0; r < rows.table.size(); ++r) {
    const double depth = rows.table.d_hat[r] - rows.table.d[r];
    energy += rows.table.multiplicity[r] * rows.table.kappa[r] * depth * depth;
  }
  return energy;
}

/// A memory in which one pair of the only row has kappa = 7; `one` becomes the row with that pair alone.
KappaMemory knows_one_pair(const Rows& rows, std::size_t pair, Rows& one) {
  one = rows;
  one.table.pair = {rows.table.pair[pair]};
  one.table.pair_begin = {0, 1};
  one.table.parts[0] = {7, 0};
  KappaMemory memory;
  memory.store(one.table, one.mollified);
  return memory;
}

TEST(KappaMemory, BIsContinuousWhereAPointSlidesOverAnEdge) {
  const Scene scene = point_over_fan();
  ContactSystem contacts(scene, {});
  Rows before = at(contacts, scene, -1e-9), after = at(contacts, scene, 1e-9);
  ASSERT_EQ(before.table.size(), 2U);  // on one triangle, and on the edge of the other
  ASSERT_EQ(after.table.size(), 2U);
  for (std::size_t r = 0; r < 2; ++r) {
    before.table.kappa[r] = before.table.kind[r] == ContactKind::point_triangle ? 7 : 3;
    before.table.parts[r].fixed = before.table.kappa[r];
  }
  KappaMemory memory;
  memory.store(before.table, before.mollified);

  std::vector<int> missing, missing_mollified;
  memory.recall(after.table, after.mollified, missing, missing_mollified);

  EXPECT_TRUE(missing.empty());
  for (std::size_t r = 0; r < 2; ++r) {  // each pair took its kappa along
    EXPECT_EQ(after.table.kappa[r], after.table.kind[r] == ContactKind::point_triangle ? 3 : 7);
  }
  EXPECT_GT(barrier_energy(before), 0.01);
  EXPECT_NEAR(barrier_energy(after), barrier_energy(before), 1e-8);
}

TEST(KappaMemory, ARowOfKnownAndNewPairsHasTheirMean) {
  const Scene scene = point_over_fan();
  ContactSystem contacts(scene, {});
  Rows rows = at(contacts, scene, 0);  // over the edge: both triangles' pairs in one row
  ASSERT_EQ(rows.table.size(), 1U);
  ASSERT_EQ(rows.table.multiplicity[0], 2);
  Rows one;
  KappaMemory memory = knows_one_pair(rows, 0, one);

  std::vector<int> missing, missing_mollified;
  memory.recall(rows.table, rows.mollified, missing, missing_mollified);
  ASSERT_EQ(missing, std::vector<int>{0});
  rows.table.parts[0] = {3, 0.01};  // what the policy gives the new pair
  memory.complete(rows.table, missing, rows.mollified, missing_mollified);
  const double fallen = 0.01 / std::pow(rows.table.d[0], 2);
  EXPECT_EQ(rows.table.parts[0].fixed, 5);
  EXPECT_EQ(rows.table.parts[0].per_gap_sq, 0.005);
  EXPECT_DOUBLE_EQ(rows.table.kappa[0], 5 + fallen / 2);

  memory.store(rows.table, rows.mollified);  // the new pair is known with 3, not with the mean
  one.table.pair = {rows.table.pair[1]};
  memory.recall(one.table, one.mollified, missing, missing_mollified);
  EXPECT_TRUE(missing.empty());
  EXPECT_DOUBLE_EQ(one.table.kappa[0], 3 + fallen);
}

/// A point above the corner of three triangles; one of the three pairs is known.
TEST(KappaMemory, EveryNewPairOfARowCounts) {
  Scene scene;
  add_body(scene, "point", {Vec3d(0, 0, 0.05)}, {}, 0.1);
  scene.surface_vertices = {0};
  add_body(scene, "fan", {Vec3d(0, 0, 0), Vec3d(1, 0, -1), Vec3d(-1, 1, -1), Vec3d(-1, -1, -1)},
           {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}}, 0.1);
  ContactSystem contacts(scene, {});
  Rows rows = rows_at(contacts, scene.x0);
  ASSERT_EQ(rows.table.size(), 1U);
  ASSERT_EQ(rows.table.multiplicity[0], 3);
  Rows one;
  const KappaMemory memory = knows_one_pair(rows, 1, one);

  std::vector<int> missing, missing_mollified;
  memory.recall(rows.table, rows.mollified, missing, missing_mollified);
  rows.table.parts[0] = {3, 0};
  memory.complete(rows.table, missing, rows.mollified, missing_mollified);
  EXPECT_DOUBLE_EQ(rows.table.kappa[0], (7 + 3 + 3) / 3.0);
}

template <class Table>
void set_kappa(Table& table, std::size_t r, double kappa) {
  table.parts[r] = {kappa, 0};
  table.kappa[r] = kappa;
}

/// Tables of a state with kappa = 1, 2, 3, ... in row order.
Rows numbered(ContactSystem& contacts, const Positions& x) {
  Rows rows = rows_at(contacts, x);
  for (std::size_t r = 0; r < rows.table.size(); ++r) set_kappa(rows.table, r, static_cast<double>(r + 1));
  for (std::size_t r = 0; r < rows.mollified.size(); ++r) {
    set_kappa(rows.mollified, r, 1000 + static_cast<double>(r));
  }
  return rows;
}

/// Sum of the kappa that the pairs of a row had in `stored`, and how many were there.
std::pair<double, int> known_share(const Rows& stored, const ContactTable& table, std::size_t row) {
  double sum = 0;
  int n = 0;
  for (std::size_t i = table.pair_begin[row]; i < table.pair_begin[row + 1]; ++i) {
    for (std::size_t r = 0; r < stored.table.size(); ++r) {
      for (std::size_t k = stored.table.pair_begin[r]; k < stored.table.pair_begin[r + 1]; ++k) {
        if (stored.table.pair[k] != table.pair[i]) continue;
        sum += stored.table.kappa[r];
        ++n;
      }
    }
    for (std::size_t r = 0; r < stored.mollified.size(); ++r) {
      if (stored.mollified.pair[r] != table.pair[i]) continue;
      sum += stored.mollified.kappa[r];
      ++n;
    }
  }
  return {sum, n};
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
  moved.rightCols(16).colwise() += Vec3d(0.24, 0.05, 0);
  Rows other = rows_at(contacts, moved);
  memory.recall(other.table, other.mollified, missing, missing_mollified);
  EXPECT_GT(missing.size(), 0U);
  EXPECT_LT(missing.size(), other.table.size());
  for (std::size_t r = 0; r < other.table.size(); ++r) {
    const bool reported = std::binary_search(missing.begin(), missing.end(), static_cast<int>(r));
    const auto [sum, n] = known_share(stored, other.table, r);
    EXPECT_EQ(reported, static_cast<double>(n) < other.table.multiplicity[r]);
    if (!reported) {
      EXPECT_EQ(other.table.kappa[r], sum / n);
    }
  }
}

TEST(KappaMemory, KnownRowsKeepTheirFirstValueUntilCleared) {
  const Scene scene = two_sheets();
  ContactSystem contacts(scene, {});
  Rows rows = numbered(contacts, scene.x0);
  KappaMemory memory;
  memory.store(rows.table, rows.mollified);
  memory.store({}, {});  // a state without contacts does not make it forget
  const std::vector<double> first = rows.table.kappa;
  for (std::size_t r = 0; r < first.size(); ++r) set_kappa(rows.table, r, first[r] + 100);
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
  scene.surface_vertices.clear();  // the pair of edges alone
  ContactSystem contacts(scene, {});
  Rows plain = rows_at(contacts, scene.x0);
  ASSERT_EQ(plain.table.size(), 1U);
  plain.table.parts[0] = {42, 0.02};
  KappaMemory memory;
  memory.store(plain.table, plain.mollified);

  Positions turned = scene.x0;
  turned(1, 2) = -0.01;
  turned(1, 3) = 0.009;
  Rows parallel = rows_at(contacts, turned);
  ASSERT_EQ(parallel.mollified.size(), 1U);
  std::vector<int> missing, missing_mollified;
  memory.recall(parallel.table, parallel.mollified, missing, missing_mollified);
  EXPECT_EQ(parallel.mollified.kappa[0], 42 + 0.02 / (parallel.mollified.d[0] * parallel.mollified.d[0]));
  EXPECT_TRUE(missing_mollified.empty());
}

}  // namespace
}  // namespace bb::test::kappa_memory_test
