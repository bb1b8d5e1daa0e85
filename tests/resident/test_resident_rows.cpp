// Rows on an executor against those of ContactSystem, pair by pair.
#include <gtest/gtest.h>

#include <map>

#include "core/exec/counting_executor.hpp"
#include "tests/contact/rods.hpp"
#include "tests/resident/contact_on_executor.hpp"

namespace bb::test {
namespace {

using resident::KappaColumns;
using resident::ResidentRows;
using resident::RowView;

struct Expected {
  std::uint8_t kind;
  std::array<int, 4> stencil;
  std::array<double, 4> weight;
  Vec3d normal;
  double d, d_hat;
  bool first;  // of its merged row: same bits
};

template <class Table>
Expected expected(const Table& t, std::size_t r, std::uint8_t kind, bool first) {
  Expected e{kind, {}, {}, Vec3d::Map(&t.normal[3 * r]), t.d[r], t.d_hat[r], first};
  std::copy_n(&t.stencil[4 * r], 4, e.stencil.begin());
  return e;
}

std::map<PairId, Expected> by_pair(const Rows& rows) {
  std::map<PairId, Expected> out;
  const ContactTable& t = rows.table;
  for (std::size_t r = 0; r < t.size(); ++r) {
    for (std::size_t i = t.pair_begin[r]; i < t.pair_begin[r + 1]; ++i) {
      Expected e = expected(t, r, static_cast<std::uint8_t>(t.kind[r]), i == t.pair_begin[r]);
      std::copy_n(&t.stencil_weight[4 * r], 4, e.weight.begin());
      out.emplace(t.pair[i], e);
    }
  }
  const MollifiedTable& m = rows.mollified;
  for (std::size_t r = 0; r < m.size(); ++r) {
    Expected e = expected(m, r, resident::mollified_kind, true);
    for (std::size_t k = 0, slot = 0; k < 4; ++k) {
      e.weight[k] = m.vertex[4 * r + k] < 0 ? 1e300 : m.weight[4 * r + slot++];  // of given ones not kept
    }
    out.emplace(m.pair[r], e);
  }
  return out;
}

void compare(const Scene& scene, ResidentRows& rows, const Rows& reference, std::array<int, 8>& n_kinds) {
  const std::map<PairId, Expected> pairs = by_pair(reference);
  const RowView v = rows.view();
  ASSERT_EQ(static_cast<std::size_t>(v.n), pairs.size());
  EXPECT_EQ(rows.min_gap, reference.min_gap);
  const Surface surface(scene);
  Index r = 0;
  for (const auto& [pair, e] : pairs) {
    ASSERT_EQ(v.pair[r], pair);
    ASSERT_EQ(v.kind[r], e.kind);
    ++n_kinds[e.kind];
    const double tolerance = e.first ? 0 : 1e-11;
    EXPECT_NEAR(v.d[r], e.d, tolerance);
    EXPECT_EQ(v.d_hat[r], e.d_hat);
    EXPECT_LE((v.normal_of(r) - e.normal).norm(), tolerance * 1e3);
    for (int k = 0; k < 4; ++k) {
      ASSERT_EQ(v.vertex[k * v.n + r], e.stencil[at(k)]);
      if (e.weight[at(k)] != 1e300) {
        EXPECT_NEAR(v.weight[k * v.n + r], e.weight[at(k)], tolerance * 1e3);
      }
      const int vertex = e.stencil[at(k)];
      EXPECT_EQ(v.is_free(r, k), vertex >= 0 && surface.vertex_free[at(vertex)] != 0);
    }
    ++r;
  }
  EXPECT_EQ(static_cast<std::size_t>(rows.list.size()), reference.mollified.size());
}

TEST(ResidentRowFinder, HasTheRowsOfTheContactSystemPairByPair) {
  std::array<int, 8> n_kinds{};
  std::size_t n_merged = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Scene scene = full_scene(seed);
    const Positions x = shaken(scene);
    ContactSystem contacts(scene, {});
    const Rows reference = rows_at(contacts, x);
    for (const double m : reference.table.multiplicity) n_merged += m > 1;
    HostExecutor executor;
    OnExecutor on(executor, scene, x);
    compare(scene, on.rows, reference, n_kinds);
  }
  for (const int n : n_kinds) EXPECT_GE(n, 20);  // of every kind, mollified ones included
  EXPECT_GT(n_merged, 20U);
}

TEST(ResidentRowFinder, HasThoseOfRods) {
  std::array<int, 8> n_kinds{};
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Scene scene = rods_and_sheet(seed, 0.04);
    ContactSystem contacts(scene, {});
    HostExecutor executor;
    OnExecutor on(executor, scene, scene.x0);
    const Rows reference = rows_at(contacts, scene.x0);
    compare(scene, on.rows, reference, n_kinds);
  }
  EXPECT_GT(n_kinds[static_cast<int>(ContactKind::point_edge)], 50);
  EXPECT_GT(n_kinds[resident::mollified_kind], 5);
}

TEST(ResidentRowFinder, HasThoseOfPlanarScenes) {
  std::array<int, 8> n_kinds{};
  for (const PlanarPairs pairs : {PlanarPairs::vertex_vertex, PlanarPairs::point_edge}) {
    const Scene scene = planar_layers(pairs, 3);
    ContactSystem contacts(scene, {});
    HostExecutor executor;
    OnExecutor on(executor, scene, scene.x0);
    compare(scene, on.rows, rows_at(contacts, scene.x0), n_kinds);
  }
  EXPECT_GT(n_kinds[0], 20);
  EXPECT_GT(n_kinds[1], 5);
}

TEST(ResidentRowFinder, GivesTheSameBitsInAnyOrder) {
  const Scene scene = full_scene(4);
  const Positions x = shaken(scene);
  std::string reference;
  unsigned seed = 1;
  for (const exec::Order order : all_orders) {
    HostExecutor executor(order, seed++);
    OnExecutor on(executor, scene, x);
    ASSERT_GT(on.rows.size(), 300);
    const std::string bytes = bytes_of(on.rows);
    if (reference.empty()) reference = bytes;
    EXPECT_TRUE(bytes == reference);
  }
}

TEST(ResidentRowFinder, NamesGapsBelowZeroAndStatesThatAreNotFinite) {
  Scene scene;
  add_body(scene, "free", {Vec3d(0, 0, 0.05), Vec3d(1, 0, -0.02), Vec3d(2, 0, -0.01)}, {}, 0.1);
  scene.obstacles.push_back({});  // the plane z = 0
  HostExecutor executor;
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

TEST(ResidentRowFinder, TellsStencilsApart) {
  const Scene scene = full_scene(2);
  HostExecutor executor;
  const Positions x = shaken(scene);
  OnExecutor a(executor, scene, x);
  OnExecutor b(executor, scene, random_motion(x, 1e-13, 5));
  ASSERT_GT(a.rows.size(), 100);
  EXPECT_TRUE(resident::same_stencils(executor, a.rows, b.rows));
  const RowView v = b.rows.view();
  v.vertex[v.n + 57] += 1;
  EXPECT_FALSE(resident::same_stencils(executor, a.rows, b.rows));
  v.vertex[v.n + 57] -= 1;
  v.free[80] ^= 1;
  EXPECT_FALSE(resident::same_stencils(executor, a.rows, b.rows));
}

TEST(ResidentRows, TakeAtMost140BytesEach) {
  constexpr Index n = 100000;
  for (const KappaColumns columns :
       {KappaColumns::uniform, KappaColumns::kept, KappaColumns::compared, KappaColumns::potential}) {
    exec::CountingExecutor executor;
    ResidentRows rows(executor, columns);
    rows.resize(n);
    const double each = static_cast<double>(executor.memory().bytes()) / n;
    EXPECT_GE(each, 122);
    EXPECT_LE(each, 140);
    // nothing hides behind the counted columns
    HostExecutor host;
    ResidentRows filled(host, columns);
    filled.resize(n);
    EXPECT_EQ(host.memory().by_name(), executor.memory().by_name());
  }
}

}  // namespace
}  // namespace bb::test
