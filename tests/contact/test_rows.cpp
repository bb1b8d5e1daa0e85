// Rows of the contact table: regions, prescribed vertices, offsets, completeness; pairs of one feature are in
// test_rows_of_one_feature.cpp.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "core/contact/candidates.hpp"
#include "core/contact/pair_geometry.hpp"
#include "tests/contact/contact_scenes.hpp"

namespace bb::test::rows_test {
namespace {

constexpr double d_hat = 0.1;

/// One triangle (0 0 0), (1 0 0), (0 1 0) as vertices 0 to 2 and a lone free vertex 3.
Scene point_over_triangle(const Vec3d& p) {
  Scene scene;
  add_body(scene, "triangle", {Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(0, 1, 0)}, {{0, 1, 2}}, d_hat);
  add_body(scene, "point", {p}, {}, d_hat);
  return scene;
}

struct RegionCase {
  Vec3d p;
  ContactKey key;
  ContactKind kind;
  double d;
};

TEST(Rows, EveryRegionOfATriangle) {
  const double s = std::sqrt(0.5);
  const RegionCase cases[] = {
      {{0.2, 0.3, 0.05}, {0, 1, 2, 3}, ContactKind::point_triangle, 0.05},
      {{0.5, -0.03, 0.04}, {-1, 0, 1, 3}, ContactKind::point_edge, 0.05},
      {{-0.03, 0.5, -0.04}, {-1, 0, 2, 3}, ContactKind::point_edge, 0.05},
      {{0.5 + 0.05 * s, 0.5 + 0.05 * s, 0}, {-1, 1, 2, 3}, ContactKind::point_edge, 0.05},
      {{-0.03, -0.04, 0}, {-1, -1, 0, 3}, ContactKind::point_point, 0.05},
      {{1.05, -0.01, 0}, {-1, -1, 1, 3}, ContactKind::point_point, std::hypot(0.05, 0.01)},
      {{-0.01, 1.05, 0}, {-1, -1, 2, 3}, ContactKind::point_point, std::hypot(0.05, 0.01)}};
  for (const RegionCase& c : cases) {
    const Scene scene = point_over_triangle(c.p);
    ContactSystem contacts(scene, {});
    const Rows rows = rows_at(contacts, scene.x0);
    ASSERT_EQ(rows.table.size(), 1U);
    const ContactTable& t = rows.table;
    EXPECT_EQ(t.key(0), c.key);
    EXPECT_EQ(t.kind[0], c.kind);
    EXPECT_NEAR(t.d[0], c.d, 1e-15);
    EXPECT_EQ(rows.min_gap, t.d[0]);
    EXPECT_EQ(t.d_hat[0], d_hat);
    // what the columns promise: r = sum w x is (d + offset) n, n is unit
    Vec3d r = Vec3d::Zero();
    double sum = 0;
    for (std::size_t k = 0; k < 4 && t.stencil[k] >= 0; ++k) {
      r += t.stencil_weight[k] * scene.x0.col(t.stencil[k]);
      sum += t.stencil_weight[k];
    }
    EXPECT_NEAR((r - t.d[0] * Vec3d::Map(&t.normal[0])).norm(), 0, 1e-15);
    EXPECT_NEAR(sum, 0, 1e-15);
    EXPECT_NEAR(Vec3d::Map(&t.normal[0]).norm(), 1, 1e-15);
  }
}

TEST(Rows, NoneBeyondTheActivationDistance) {
  const Scene scene = point_over_triangle(Vec3d(0.2, 0.2, d_hat * 1.0001));
  ContactSystem contacts(scene, {});
  const Rows rows = rows_at(contacts, scene.x0);
  EXPECT_EQ(rows.table.size(), 0U);
  EXPECT_EQ(rows.min_gap, std::numeric_limits<double>::infinity());
}

/// Two rods of one edge each.
Scene two_edges(const Vec3d& a0, const Vec3d& a1, const Vec3d& b0, const Vec3d& b1) {
  Scene scene;
  add_body(scene, "a", {a0, a1}, {}, d_hat);
  add_body(scene, "b", {b0, b1}, {}, d_hat);
  scene.surface_edges = {{0, 1}, {2, 3}};
  return scene;
}

TEST(Rows, EveryRegionOfTwoEdges) {
  struct Case {
    Vec3d b0, b1;
    ContactKey key;
    ContactKind kind;
    double d;
  };
  const Case cases[] = {{{0.5, -1, 0.05}, {0.5, 1, 0.05}, {0, 1, 2, 3}, ContactKind::edge_edge, 0.05},
                        {{0.5, 0.05, 0}, {0.5, 1, 0}, {-1, 0, 1, 2}, ContactKind::point_edge, 0.05},
                        {{0.5, -1, 0}, {0.5, -0.05, 0}, {-1, 0, 1, 3}, ContactKind::point_edge, 0.05},
                        {{-0.05, -1, 0}, {-0.05, 1, 0}, {-1, 0, 2, 3}, ContactKind::point_edge, 0.05},
                        {{1.05, -1, 0}, {1.05, 1, 0}, {-1, 1, 2, 3}, ContactKind::point_edge, 0.05},
                        {{1.03, 0.04, 0}, {1.2, 1, 0}, {-1, -1, 1, 2}, ContactKind::point_point, 0.05},
                        {{-0.2, 1, 0}, {-0.03, 0.04, 0}, {-1, -1, 0, 3}, ContactKind::point_point, 0.05}};
  for (const Case& c : cases) {
    const Scene scene = two_edges({0, 0, 0}, {1, 0, 0}, c.b0, c.b1);
    ContactSystem contacts(scene, {});
    const Rows rows = rows_at(contacts, scene.x0);
    ASSERT_GE(rows.table.size(), 1U);  // vertices of rods pair with edges too
    EXPECT_EQ(rows.mollified.size(), 0U);
    const ContactTable& t = rows.table;
    EXPECT_EQ(pair_list(t.pair.back()), static_cast<int>(PairKind::edge_edge));
    for (std::size_t row = 0; row < t.size(); ++row) {
      EXPECT_EQ(t.key(row), c.key);
      EXPECT_EQ(t.kind[row], c.kind);
      EXPECT_NEAR(t.d[row], c.d, 1e-15);
      Vec3d r = Vec3d::Zero();
      for (std::size_t k = 4 * row; k < 4 * row + 4 && t.stencil[k] >= 0; ++k) {
        r += t.stencil_weight[k] * scene.x0.col(t.stencil[k]);
      }
      EXPECT_NEAR((r - t.d[row] * Vec3d::Map(&t.normal[3 * row])).norm(), 0, 1e-15);
      EXPECT_GT(t.stencil_weight[4 * row], 0);
    }
  }
}

TEST(Rows, PrescribedVerticesHaveNoColumns) {
  const Scene scene = point_over_grid(Vec3d(1.7, 1.2, 0.05), d_hat, true);
  ContactSystem contacts(scene, {});
  const Rows rows = rows_at(contacts, scene.x0);
  ASSERT_EQ(rows.table.size(), 1U);
  const ContactTable& t = rows.table;
  EXPECT_EQ(t.kind[0], ContactKind::point_triangle);
  EXPECT_EQ(t.n_free[0], 1);
  EXPECT_EQ(t.vertex, (std::vector<int>{25, -1, -1, -1}));
  EXPECT_EQ(t.weight, (std::vector<double>{1, 0, 0, 0}));
  EXPECT_EQ(t.key(0), (ContactKey{6, 7, 12, 25}));  // the identity keeps them

  const Scene moving = point_over_grid(Vec3d(1.7, 1.2, 0.05), d_hat, false);
  ContactSystem contacts2(moving, {});
  const Rows both = rows_at(contacts2, moving.x0);
  ASSERT_EQ(both.table.size(), 1U);
  EXPECT_EQ(both.table.n_free[0], 4);
  EXPECT_NEAR(both.table.weight[1] + both.table.weight[2] + both.table.weight[3], -1, 1e-15);
}

TEST(Rows, NoneWhereTheClosestFeatureIsWhollyGiven) {
  Scene scene;
  add_body(scene, "cloth", {Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(0, 1, 0)}, {{0, 1, 2}}, d_hat);
  scene.pins = {{0, 0}, {1, 0}};  // vertex 2 is free
  scene.motions.push_back({});
  add_body(scene, "given", {Vec3d(0.5, -0.05, 0)}, {}, d_hat, true);
  ContactSystem contacts(scene, {});
  EXPECT_EQ(rows_at(contacts, scene.x0).table.size(), 0U);
  EXPECT_EQ(contacts.candidate_counts().point_triangle, 1U);
}

TEST(Rows, OffsetsAddUpAndDistancesAreMeans) {
  Scene scene = point_over_triangle(Vec3d(0.25, 0.25, 0.07));
  scene.offset = {0.01, 0.01, 0.01, 0.02};
  scene.d_hat = {0.03, 0.03, 0.03, 0.07};
  ContactSystem contacts(scene, {});
  const Rows rows = rows_at(contacts, scene.x0);
  ASSERT_EQ(rows.table.size(), 1U);
  EXPECT_NEAR(rows.table.offset[0], 0.03, 1e-16);
  EXPECT_NEAR(rows.table.d_hat[0], 0.05, 1e-16);
  EXPECT_NEAR(rows.table.d[0], 0.04, 1e-15);
}

/// Every candidate pair whose closest points are nearer than d_hat has one row, and no other.
TEST(Rows, HoldEveryPairThatItsClosestPointsBringNear) {
  Scene scene;
  const auto [v1, t1] = soup(150, 0.2, 1);
  const auto [v2, t2] = soup(150, 0.2, 2);
  add_body(scene, "a", v1, t1, 0.05);
  add_body(scene, "b", v2, t2, 0.03, false, 0.01);
  for (int v = 0; v < scene.n_vertices(); ++v) scene.body[at(v)] = v;  // no rest rule
  const Surface surface(scene);
  BroadPhase broad_phase(surface, {}, plan_contact(scene));
  Candidates candidates;
  broad_phase.update(scene.x0, scene.x0, candidates);
  std::size_t n_near = 0, n_far = 0;
  double least = std::numeric_limits<double>::infinity();
  for_each_kind(candidates, [&]<PairKind K>(const std::vector<IndexPair>& pairs) {
    for (const IndexPair index : pairs) {
      const ContactPair<K> pair = contact_pair<K>(surface, index);
      const double gap = closest_points<K, double>(gather(scene.x0, pair.vertex)).d - pair.law.offset;
      ++(gap < pair.law.d_hat ? n_near : n_far);
      least = std::min(least, gap);
    }
  });
  ContactSystem contacts(scene, {});
  const Rows rows = rows_at(contacts, scene.x0);
  EXPECT_EQ(rows.table.pair.size() + rows.mollified.size(), n_near);
  EXPECT_EQ(rows.min_gap, least);
  EXPECT_GT(n_near, 300U);
  EXPECT_GT(n_far, 300U);
}

TEST(Rows, InTheOrderOfTheirPairsAndTheSameForAnyNumberOfThreads) {
  Scene scene;
  const auto [v1, t1] = soup(150, 0.2, 1);
  add_body(scene, "a", v1, t1, 0.05);
  const auto [v2, t2] = soup(150, 0.2, 2);
  add_body(scene, "b", v2, t2, 0.05);
  Rows reference;
  for (std::size_t threads : {1, 2, 6}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    ContactSystem contacts(scene, {});
    const Rows rows = rows_at(contacts, scene.x0);
    if (threads == 1) reference = rows;
    EXPECT_EQ(rows.table.pair, reference.table.pair);
    EXPECT_EQ(rows.table.d, reference.table.d);
    EXPECT_EQ(rows.table.weight, reference.table.weight);
    EXPECT_EQ(rows.mollified.pair, reference.mollified.pair);
  }
  const ContactTable& t = reference.table;
  ASSERT_GT(t.size(), 200U);
  for (std::size_t r = 1; r < t.size(); ++r) EXPECT_LT(t.pair[r - 1], t.pair[r]);
}

TEST(Rows, ObstaclesActOnFreeVerticesWithASignedGap) {
  Scene scene;
  add_body(scene, "free", {Vec3d(0, 0, 0.05), Vec3d(1, 0, -0.02), Vec3d(2, 0, 0.2), Vec3d(4, 0, 0.105)}, {},
           d_hat, false, 0.01);
  add_body(scene, "given", {Vec3d(3, 0, 0.05)}, {}, d_hat, true);
  scene.obstacles.push_back({});  // the plane z = 0
  ContactSystem contacts(scene, {});
  const Rows rows = rows_at(contacts, scene.x0);
  ASSERT_EQ(rows.table.size(), 3U);
  EXPECT_NEAR(rows.table.d[2], 0.095, 1e-16);  // within d_hat by its offset alone
  EXPECT_EQ(rows.table.key(0), (ContactKey{-1, -1, -2, 0}));
  EXPECT_EQ(rows.table.key(1), (ContactKey{-1, -1, -2, 1}));
  EXPECT_EQ(rows.table.kind[0], ContactKind::obstacle);
  EXPECT_NEAR(rows.table.d[0], 0.04, 1e-16);
  EXPECT_NEAR(rows.table.d[1], -0.03, 1e-16);
  EXPECT_EQ(rows.min_gap, rows.table.d[1]);
  EXPECT_EQ(rows.table.normal[2], 1);
  EXPECT_EQ(rows.table.n_free[0], 1);
}

}  // namespace
}  // namespace bb::test::rows_test
