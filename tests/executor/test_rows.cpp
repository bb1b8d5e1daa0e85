// Rows on an executor against those of ContactSystem, pair by pair.
#include <gtest/gtest.h>

#include <set>

#include "core/exec/counting_executor.hpp"
#include "tests/contact/rods.hpp"
#include "tests/executor/rows_pair_by_pair.hpp"
#include "tests/executor/tested_executor.hpp"

namespace bb::test::executor_rows_test {
namespace {

using exec::ExecutorRows;
using exec::KappaColumns;
using exec::RowView;

TEST(ExecutorRowFinder, HasTheRowsOfTheContactSystemPairByPair) {
  std::array<int, 8> n_kinds{};
  std::size_t n_shared = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Scene scene = full_scene(seed);
    const Positions x = shaken(scene);
    ContactSystem contacts(scene, {});
    const Rows reference = rows_at(contacts, x);
    const std::vector<ContactKey> all = keys_of(reference.table);
    const std::multiset<ContactKey> keys(all.begin(), all.end());
    for (const ContactKey& key : all) n_shared += keys.count(key) > 1;
    TestedExecutor executor;
    OnExecutor on(executor, scene, x);
    compare(scene, on.rows, reference, n_kinds);
  }
  for (const int n : n_kinds) EXPECT_GE(n, 20);  // of every kind, mollified ones included
  EXPECT_GT(n_shared, 40U);
}

TEST(ExecutorRowFinder, HasThoseOfRods) {
  std::array<int, 8> n_kinds{};
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Scene scene = rods_and_sheet(seed, 0.04);
    ContactSystem contacts(scene, {});
    TestedExecutor executor;
    OnExecutor on(executor, scene, scene.x0);
    const Rows reference = rows_at(contacts, scene.x0);
    compare(scene, on.rows, reference, n_kinds);
  }
  EXPECT_GT(n_kinds[static_cast<int>(ContactKind::point_edge)], 50);
  EXPECT_GT(n_kinds[mollified_kind], 5);
}

TEST(ExecutorRowFinder, HasThoseOfPlanarScenes) {
  std::array<int, 8> n_kinds{};
  for (const PlanarPairs pairs : {PlanarPairs::vertex_vertex, PlanarPairs::point_edge}) {
    const Scene scene = planar_layers(pairs, 3);
    ContactSystem contacts(scene, {});
    TestedExecutor executor;
    OnExecutor on(executor, scene, scene.x0);
    compare(scene, on.rows, rows_at(contacts, scene.x0), n_kinds);
  }
  EXPECT_GT(n_kinds[0], 20);
  EXPECT_GT(n_kinds[1], 5);
}

TEST(ExecutorRowFinder, GivesTheSameBitsInAnyOrder) {
  const Scene scene = full_scene(4);
  const Positions x = shaken(scene);
  std::string reference;
  unsigned seed = 1;
  for (const exec::Order order : all_orders) {
    TestedExecutor executor(order, seed++);
    OnExecutor on(executor, scene, x);
    ASSERT_GT(on.rows.size(), 300);
    const std::string bytes = bytes_of(on.rows);
    if (reference.empty()) reference = bytes;
    EXPECT_TRUE(bytes == reference);
  }
}

TEST(ExecutorRowFinder, NamesGapsBelowZeroAndStatesThatAreNotFinite) {
  Scene scene;
  add_body(scene, "free", {Vec3d(0, 0, 0.05), Vec3d(1, 0, -0.02), Vec3d(2, 0, -0.01)}, {}, 0.1);
  scene.obstacles.push_back({});  // the plane z = 0
  TestedExecutor executor;
  OnExecutor on(executor, scene, scene.x0);
  EXPECT_EQ(on.rows.size(), 3);
  EXPECT_EQ(on.rows.min_gap, -0.02);
  EXPECT_FALSE(on.rows.feasible());

  Positions apart = scene.x0;
  apart.row(2).setConstant(1);
  upload(on.x, apart);
  on.finder.find(on.x, on.candidates, on.rows);
  EXPECT_EQ(on.rows.size(), 0);
  EXPECT_EQ(on.rows.min_gap, std::numeric_limits<double>::infinity());

  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Positions x = scene.x0;
    x(1, 1) = bad;
    upload(on.x, x);
    on.finder.find(on.x, on.candidates, on.rows);
    EXPECT_EQ(on.rows.size(), 0);
    EXPECT_EQ(on.rows.min_gap, -std::numeric_limits<double>::infinity());
  }
}

TEST(ExecutorRowFinder, TellsStencilsApart) {
  const Scene scene = full_scene(2);
  TestedExecutor executor;
  const Positions x = shaken(scene);
  OnExecutor a(executor, scene, x);
  OnExecutor b(executor, scene, random_motion(x, 1e-13, 5));
  ASSERT_GT(a.rows.size(), 100);
  const auto same = [&] {
    a.finder.compare(a.rows, b.rows);
    return a.finder.same();
  };
  EXPECT_TRUE(same());
  const RowView v = b.rows.view();
  v.vertex[v.n + 57] += 1;
  EXPECT_FALSE(same());
  v.vertex[v.n + 57] -= 1;
  v.free[80] ^= 1;
  EXPECT_FALSE(same());
}

TEST(ExecutorRows, TakeAtMost140BytesEach) {
  constexpr Index n = Index{1} << 27;  // where no column can grow
  for (const KappaColumns columns :
       {KappaColumns::uniform, KappaColumns::kept, KappaColumns::compared, KappaColumns::potential}) {
    exec::CountingExecutor executor;
    ExecutorRows rows(executor, columns);
    rows.resize(n);
    const double each = static_cast<double>(executor.memory().bytes()) / n;
    EXPECT_GE(each, 122);
    EXPECT_LE(each, 140);
    // nothing hides behind the counted columns
    TestedExecutor host;
    exec::CountingExecutor counting;
    ExecutorRows filled(host, columns), counted(counting, columns);
    filled.resize(100000), counted.resize(100000);
    EXPECT_EQ(host.memory().by_name(), counting.memory().by_name());
  }
}

}  // namespace
}  // namespace bb::test::executor_rows_test
