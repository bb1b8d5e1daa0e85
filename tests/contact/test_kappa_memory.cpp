// A row that continues a contact on a neighbouring feature keeps its stiffness, so that B does
// not jump there: the memory of a StiffnessUpdate, in any order of its items.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/contact/stiffness_update.hpp"
#include "core/exec/host_executor.hpp"
#include "tests/barriers/host_policy.hpp"
#include "tests/contact/contact_scenes.hpp"

namespace bb::test::kappa_memory_test {
namespace {

/// Refreshed once a step; with a potential kappa has both parts, and what a trial meets is known from then on.
struct StepPolicy final : HostPolicy {
  explicit StepPolicy(bool with_potential) : potential(with_potential) {}
  bool has_potential() const override { return potential; }
  bool potential;
};

/// The memory of a step. Rows of pairs that it does not know are reported, and get `given`.
struct Memory {
  explicit Memory(bool potential = false, exec::Order order = exec::Order::threads)
      : executor(order), policy(potential) {}
  static std::array<StiffnessRows, 2> views(Rows& rows) {
    return {stiffness_rows(rows.table), stiffness_rows(rows.mollified)};
  }
  void store(Rows& rows) { update.keep(views(rows)); }
  void recall(Rows& rows) {
    missing.clear(), missing_mollified.clear();
    const auto tables = views(rows);
    update.freeze(tables, {}, [&](std::size_t of, const std::uint8_t* marked, bool at_d_hat) {
      EXPECT_TRUE(at_d_hat);
      for (Index r = 0; r < tables[of].n; ++r) {
        if (marked[r] == 0) continue;
        (of == 0 ? missing : missing_mollified).push_back(static_cast<int>(r));
        tables[of].set(r, given);
      }
    });
  }
  exec::HostExecutor executor;
  StepPolicy policy;
  StiffnessUpdate update{executor, policy};
  KappaParts given;
  std::vector<int> missing, missing_mollified;
};

/// Refreshed in every iteration: the rows of the iterate are the memory.
struct IterationPolicy final : HostPolicy {
  Refresh refresh() const override { return Refresh::per_iteration; }
};

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
    energy += rows.table.kappa[r] * depth * depth;
  }
  return energy;
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
  Memory memory;
  memory.store(before);
  memory.recall(after);

  EXPECT_TRUE(memory.missing.empty());
  for (std::size_t r = 0; r < 2; ++r) {  // each pair took its kappa along
    EXPECT_EQ(after.table.kappa[r], after.table.kind[r] == ContactKind::point_triangle ? 3 : 7);
  }
  EXPECT_GT(barrier_energy(before), 0.01);
  EXPECT_NEAR(barrier_energy(after), barrier_energy(before), 1e-8);
}

TEST(KappaMemory, OfPairsWithOneFeatureIsThatOfEach) {
  const Scene scene = point_over_fan();
  ContactSystem contacts(scene, {});
  Rows rows = at(contacts, scene, 0);  // over the edge: both triangles' pairs are closest there
  ASSERT_EQ(rows.table.size(), 2U);
  ASSERT_EQ(rows.table.key(0), rows.table.key(1));
  rows.table.parts[1] = {7, 0.02};
  Rows one = rows;  // the second pair alone
  one.table.pair = {rows.table.pair[1]};
  one.table.parts = {rows.table.parts[1]};
  one.table.d = {rows.table.d[1]};
  one.table.kappa = {0};
  Memory memory(true);
  memory.store(one);

  memory.given = {3, 0};
  memory.recall(rows);
  EXPECT_EQ(memory.missing, std::vector<int>{0});
  EXPECT_DOUBLE_EQ(rows.table.kappa[1], 7 + 0.02 / std::pow(rows.table.d[1], 2));
  const KnownStiffness known = memory.update.known();
  ASSERT_EQ(known.pair, rows.table.pair);
  EXPECT_EQ(known.parts[0].fixed, 3);
  EXPECT_EQ(known.parts[1].fixed, 7);
  EXPECT_EQ(known.parts[1].per_gap_sq, 0.02);
}

TEST(KappaMemory, RowsOfAStepsStartThatNothingRefreshedHaveNone) {
  const Scene scene = point_over_fan();
  ContactSystem contacts(scene, {});
  Rows start = at(contacts, scene, -1e-9);
  ASSERT_EQ(start.table.size(), 2U);
  exec::HostExecutor executor;
  const IterationPolicy policy;
  StiffnessUpdate update(executor, policy);
  const auto kappa_after_freeze = [&] {
    Rows trial = at(contacts, scene, 1e-9);
    const std::array<StiffnessRows, 2> trials = Memory::views(trial), iterates = Memory::views(start);
    update.freeze(trials, iterates, [&](std::size_t of, const std::uint8_t* marked, bool) {
      for (Index r = 0; r < trials[of].n; ++r) {
        if (marked[r] != 0) trials[of].set(r, {5, 0});
      }
    });
    return trial.table.kappa;
  };
  const auto refresh = [&] {
    const std::array<StiffnessRows, 2> iterates = Memory::views(start);
    update.refresh(iterates, [&](std::size_t of, const std::uint8_t*, bool) {
      for (Index r = 0; r < iterates[of].n; ++r) iterates[of].set(r, {3, 0});
    });
  };
  update.begin_step();
  EXPECT_EQ(kappa_after_freeze(), (std::vector<double>{5, 5}));
  refresh();
  EXPECT_EQ(kappa_after_freeze(), (std::vector<double>{3, 3}));
  update.begin_step();
  EXPECT_EQ(kappa_after_freeze(), (std::vector<double>{5, 5}));
  const std::array<StiffnessRows, 2> accepted = Memory::views(start);
  update.keep(accepted);
  EXPECT_EQ(kappa_after_freeze(), (std::vector<double>{3, 3}));
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

/// kappa of every pair of both tables.
std::map<PairId, double> kappa_of(const Rows& rows) {
  std::map<PairId, double> out;
  for (std::size_t r = 0; r < rows.table.size(); ++r) out[rows.table.pair[r]] = rows.table.kappa[r];
  for (std::size_t r = 0; r < rows.mollified.size(); ++r)
    out[rows.mollified.pair[r]] = rows.mollified.kappa[r];
  return out;
}

Scene two_sheets() {
  Scene scene;
  const auto [v1, t1] = grid(3, 3, 0.3);
  const auto [v2, t2] = grid(3, 3, 0.31, Vec3d(0.013, 0.027, 0.06));
  add_body(scene, "low", v1, t1, 0.1);
  add_body(scene, "high", v2, t2, 0.1);
  return scene;
}

void gives_back(exec::Order order) {
  const Scene scene = two_sheets();
  ContactSystem contacts(scene, {});
  Rows stored = numbered(contacts, scene.x0);
  ASSERT_GT(stored.table.size(), 10U);
  ASSERT_GT(stored.mollified.size(), 0U);
  Memory memory(false, order);
  memory.store(stored);

  Rows same = rows_at(contacts, scene.x0);
  memory.recall(same);
  EXPECT_TRUE(memory.missing.empty() && memory.missing_mollified.empty());
  EXPECT_EQ(same.table.kappa, stored.table.kappa);
  EXPECT_EQ(same.mollified.kappa, stored.mollified.kappa);

  Positions moved = scene.x0;
  moved.rightCols(16).colwise() += Vec3d(0.24, 0.05, 0);
  Rows other = rows_at(contacts, moved);
  memory.recall(other);
  EXPECT_GT(memory.missing.size(), 0U);
  EXPECT_LT(memory.missing.size(), other.table.size());
  const std::map<PairId, double> known = kappa_of(stored);
  const auto expect_known = [&known](const auto& table, const std::vector<int>& reported) {
    for (std::size_t r = 0; r < table.size(); ++r) {
      const auto found = known.find(table.pair[r]);
      EXPECT_EQ(std::binary_search(reported.begin(), reported.end(), static_cast<int>(r)),
                found == known.end());
      if (found != known.end()) {
        EXPECT_EQ(table.kappa[r], found->second);
      }
    }
  };
  expect_known(other.table, memory.missing);
  expect_known(other.mollified, memory.missing_mollified);

  // with the new ones it knows all pairs of both states, ascending
  memory.store(other);
  const std::vector<PairId> pairs = memory.update.known().pair;
  EXPECT_TRUE(std::is_sorted(pairs.begin(), pairs.end()));
  EXPECT_EQ(std::adjacent_find(pairs.begin(), pairs.end()), pairs.end());
  EXPECT_EQ(pairs.size(), known.size() + memory.missing.size() + memory.missing_mollified.size());
}

TEST(KappaMemory, GivesBackWhatItStoredAndReportsTheRestInEveryOrder) {
  for (const exec::Order order :
       {exec::Order::threads, exec::Order::forward, exec::Order::reverse, exec::Order::shuffled})
    gives_back(order);
}

TEST(KappaMemory, KnownRowsKeepTheirFirstValueUntilCleared) {
  const Scene scene = two_sheets();
  ContactSystem contacts(scene, {});
  Rows rows = numbered(contacts, scene.x0), none;
  none.table.resize(0), none.mollified.resize(0);
  Memory memory;
  memory.store(rows);
  memory.store(none);  // a state without contacts does not make it forget
  const std::vector<double> first = rows.table.kappa;
  for (std::size_t r = 0; r < first.size(); ++r) set_kappa(rows.table, r, first[r] + 100);
  memory.store(rows);
  memory.recall(rows);
  EXPECT_EQ(rows.table.kappa, first);

  memory.update.begin_step();
  memory.recall(rows);
  EXPECT_EQ(memory.missing.size(), rows.table.size());
  EXPECT_EQ(memory.missing_mollified.size(), rows.mollified.size());
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
  Memory memory(true);
  memory.store(plain);

  Positions turned = scene.x0;
  turned(1, 2) = -0.01;
  turned(1, 3) = 0.009;
  Rows parallel = rows_at(contacts, turned);
  ASSERT_EQ(parallel.mollified.size(), 1U);
  memory.recall(parallel);
  EXPECT_EQ(parallel.mollified.kappa[0], 42 + 0.02 / (parallel.mollified.d[0] * parallel.mollified.d[0]));
  EXPECT_TRUE(memory.missing_mollified.empty());
}

}  // namespace
}  // namespace bb::test::kappa_memory_test
