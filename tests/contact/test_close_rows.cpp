// Rows and B of thick bodies of every kind against all pairs by brute force: the same pairs, gaps, weights and energy.
#include <gtest/gtest.h>

#include <set>

#include "core/geometry/edge_edge_mollifier.hpp"
#include "tests/contact/close_bodies.hpp"

namespace bb::test::close_rows_test {
namespace {

/// A pair that is nearer than its activation distance.
struct NearPair {
  double gap, d_hat, mollifier;
};

/// Two thirds of the gap at rest in one body, where that is less (Contact rows).
double d_hat_of(const Scene& scene, const TruePair& pair) {
  if (pair.obstacle >= 0 || scene.body[at(pair.first[0])] != scene.body[at(pair.second[0])])
    return pair.d_hat;
  const double rest = true_gap(scene, pair, scene.rest);
  return rest > 0 && rest < 1.5 * pair.d_hat ? rest / 1.5 : pair.d_hat;
}

/// (2 - c/eps) c/eps of two edges, or of an edge and an axis, below a thousandth of what a right angle has at rest.
double mollifier_of(const Scene& scene, const TruePair& pair, const Positions& x) {
  const bool bar = pair.obstacle >= 0 && scene.obstacles[at(pair.obstacle)].kind == ObstacleKind::cylinder &&
                   !scene.obstacles[at(pair.obstacle)].inside && !scene.planar;
  if (pair.first.size() != 2 || !(bar || pair.second.size() == 2)) return 1;
  const auto edge = [](const Positions& y, const std::vector<int>& e) -> Vec3d {
    return y.col(e[1]) - y.col(e[0]);
  };
  double size = edge(scene.rest, pair.first).squaredNorm();
  if (!bar) size *= edge(scene.rest, pair.second).squaredNorm();
  const Vec3d other = bar ? scene.obstacles[at(pair.obstacle)].axis : edge(x, pair.second);
  const double part = edge(x, pair.first).cross(other).squaredNorm() / (1e-3 * size);
  return part < 1 ? (2 - part) * part : 1;
}

std::vector<NearPair> near_pairs(const Scene& scene, const Positions& x) {
  std::vector<NearPair> out;
  for (const TruePair& pair : TruePairs(scene).pairs) {
    const double gap = true_gap(scene, pair, x), d_hat = d_hat_of(scene, pair);
    if (gap < d_hat) out.push_back({gap, d_hat, mollifier_of(scene, pair, x)});
  }
  std::sort(out.begin(), out.end(), [](const NearPair& a, const NearPair& b) { return a.gap < b.gap; });
  return out;
}

struct Tally {
  int kinds[7] = {}, mollified = 0, shared = 0, thick = 0, shortened = 0;
  std::size_t rows = 0;
};

/// Every row says the distance of its closest points along its normal.
void expect_columns(const ContactTable& t, const Positions& x, Tally& tally) {
  const std::vector<ContactKey> all = keys_of(t);
  const std::multiset<ContactKey> keys(all.begin(), all.end());
  for (std::size_t r = 0; r < t.size(); ++r) {
    const Vec3d n = Vec3d::Map(&t.normal[3 * r]);
    double sum = 0;
    Vec3d closest = Vec3d::Zero();
    for (std::size_t k = 0; k < 4 && t.stencil[4 * r + k] >= 0; ++k) {
      sum += t.stencil_weight[4 * r + k];
      closest += t.stencil_weight[4 * r + k] * x.col(t.stencil[4 * r + k]);
    }
    ++tally.kinds[static_cast<int>(t.kind[r])];
    tally.shared += keys.count(t.key(r)) > 1;
    tally.thick += t.offset[r] > 0;
    EXPECT_NEAR(n.norm(), 1, 1e-12);
    EXPECT_NEAR(sum, is_obstacle(t.kind[r]) ? 1 : 0, 1e-9);
    if (is_obstacle(t.kind[r])) continue;
    EXPECT_NEAR(n.dot(closest), t.d[r] + t.offset[r], 1e-12);
    EXPECT_NEAR(closest.norm(), t.d[r] + t.offset[r], 1e-12) << "not the closest points";
  }
}

void expect_brute_force(const Scene& scene, const Positions& x, Tally& tally) {
  const std::vector<NearPair> expected = near_pairs(scene, x);
  ContactSystem contacts(scene, {});
  Rows rows = rows_at(contacts, x);
  std::vector<std::pair<double, double>> found;
  for (std::size_t r = 0; r < rows.table.size(); ++r) found.push_back({rows.table.d[r], rows.table.d_hat[r]});
  for (std::size_t r = 0; r < rows.mollified.size(); ++r)
    found.push_back({rows.mollified.d[r], rows.mollified.d_hat[r]});
  ASSERT_EQ(found.size(), expected.size());
  if (expected.empty()) return;
  std::sort(found.begin(), found.end());
  double energy = 0, largest = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_NEAR(found[i].first, expected[i].gap, 2e-13);
    const double y = expected[i].d_hat - expected[i].gap;
    energy += 3.5 * expected[i].mollifier * y * y * y / expected[i].d_hat;
    largest = std::max(largest, expected[i].d_hat);
    tally.mollified += expected[i].mollifier < 1;
  }
  EXPECT_NEAR(rows.min_gap, expected[0].gap, 2e-13);
  EXPECT_NEAR(barrier(contacts, x, 3.5, TestShape::cubic), energy,
              1e-10 * energy + 1e-14 * largest * largest);
  expect_columns(rows.table, x, tally);
  tally.rows += rows.table.size();
  for (std::size_t r = 0; r < rows.table.size(); ++r)
    tally.shortened += !is_obstacle(rows.table.kind[r]) && rows.table.d_hat[r] < 0.0099;
}

TEST(CloseRows, AreThoseOfAllPairsOfThickBodiesOfEveryKind) {
  Tally tally;
  unsigned seed = 1;
  for (const double reach : {1.0, 40.0}) {
    for_each_close_scene(40, seed, [&](CloseBodies bodies) {
      if (bodies.pairs.empty()) return;
      for (double& d : bodies.scene.d_hat) d *= reach;
      expect_brute_force(bodies.scene, approach(bodies, 0, 0.002, ++seed), tally);
    });
  }
  EXPECT_GT(tally.rows, 10000U);
  EXPECT_GE(tally.mollified, 1);
  EXPECT_GT(tally.shared, 500);
  EXPECT_GT(tally.thick, 5000);
  EXPECT_GT(tally.shortened, 5);
  for (const ContactKind kind : {ContactKind::point_point, ContactKind::point_edge,
                                 ContactKind::point_triangle, ContactKind::edge_edge, ContactKind::obstacle,
                                 ContactKind::obstacle_edge, ContactKind::obstacle_triangle})
    EXPECT_GT(tally.kinds[static_cast<int>(kind)], 50) << static_cast<int>(kind);
}

TEST(CloseRows, AreMollifiedAtTheThresholdAloneAndAddUp) {
  Tally tally;
  int bars = 0;
  for (unsigned seed = 1; seed <= 300; ++seed) {
    const Scene scene = near_parallel(seed).scene;
    const int before = tally.mollified;
    expect_brute_force(scene, scene.x0, tally);
    bars += !scene.obstacles.empty() && tally.mollified > before;
  }
  EXPECT_GT(tally.mollified, 100);
  EXPECT_GT(bars, 30);
  EXPECT_GT(tally.kinds[static_cast<int>(ContactKind::edge_edge)], 30);
}

/// Many bodies at once, with obstacles: candidates of one pair do not push out those of another.
TEST(CloseRows, OfManyBodiesAreThoseOfAllPairs) {
  Tally tally;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    Scene scene = mixed_scene(seed, seed % 4 == 0, seed % 2 ? 1 : 20);
    scene.pins.clear();  // a row that only prescribed vertices decide is left out: see Rows
    expect_brute_force(scene, random_motion(scene.x0, 0, seed), tally);
  }
  EXPECT_GT(tally.rows, 1000U);
  EXPECT_GT(tally.thick, 500);
}

}  // namespace
}  // namespace bb::test::close_rows_test
