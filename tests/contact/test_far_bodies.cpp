// Bodies far away cost what they are, and change nothing of those that are near: candidates, rows, step bound.
#include <gtest/gtest.h>

#include <map>

#include "core/contact/candidates.hpp"
#include "core/contact/far_test.hpp"
#include "core/contact/folded_axis.hpp"
#include "tests/contact/far_bodies.hpp"

namespace bb::test::far_bodies_test {
namespace {

std::size_t n_pairs(const ContactSystem::Counts& c) { return c.point_triangle + c.edge_edge; }

/// A row by the numbers that its vertices have without far bodies.
struct NearRow {
  std::vector<double> weight;
  double d, d_hat;
  Vec3d normal;
  bool operator==(const NearRow&) const = default;
};
/// Pairs of one feature in their order.
using RowsByKey = std::multimap<std::pair<ContactKind, ContactKey>, NearRow>;
RowsByKey near_rows(const FarScene& far, const ContactTable& t) {
  RowsByKey out;
  for (std::size_t r = 0; r < t.size(); ++r) {
    ContactKey key = t.key(r);
    for (int& v : key) v = v < 0 ? v : far.original[at(v)];
    out.emplace(std::pair{t.kind[r], key}, NearRow{{&t.stencil_weight[4 * r], &t.stencil_weight[4 * r] + 4},
                                                   t.d[r],
                                                   t.d_hat[r],
                                                   Vec3d::Map(&t.normal[3 * r])});
  }
  return out;
}

struct Found {
  std::size_t candidates;
  RowsByKey rows;
  double min_gap;
  StepBound bound;
};
Found found_in(const FarScene& far, Precision precision) {
  ContactOptions options;
  options.precision = precision;
  ContactSystem contacts(far.scene, options);
  contacts.update_candidates(far.scene.x0, far.x1);
  Found out;
  out.candidates = n_pairs(contacts.candidate_counts());
  out.bound = contacts.step_bound(far.scene.x0, far.x1);
  contacts.update_candidates(far.scene.x0, far.scene.x0);
  ContactTable table;
  MollifiedTable mollified;
  out.min_gap = contacts.find_rows(far.scene.x0, table, mollified);
  out.rows = near_rows(far, table);
  return out;
}

TEST(FarBodies, LeaveCandidatesRowsAndBoundOfOthersAsTheyAre) {
  for (const Precision precision : {Precision::full, Precision::single}) {
    for (const double sink : {4e-3, 0.02}) {
      const Found alone = found_in(sheets_and_far(24, sink, {}), precision);
      ASSERT_GT(alone.rows.size(), 1000U);
      ASSERT_GT(alone.candidates, 5000U);
      ASSERT_GT(alone.bound.queries, 0);
      for (const FarBodies& bodies : far_cases()) {
        const Found with = found_in(sheets_and_far(24, sink, bodies), precision);
        const auto hint = testing::Message() << bodies.n << " bodies " << bodies.distance << " m away, place "
                                             << static_cast<int>(bodies.where) << ", sink " << sink
                                             << ", precision " << static_cast<int>(precision);
        EXPECT_EQ(with.rows, alone.rows) << hint;
        EXPECT_EQ(with.min_gap, alone.min_gap) << hint;
        EXPECT_EQ(with.bound.alpha, alone.bound.alpha) << hint;
        EXPECT_LE(static_cast<double>(with.bound.queries), 1.1 * static_cast<double>(alone.bound.queries))
            << hint;
        const double most = static_cast<double>(alone.candidates) + bodies.n * bodies.n * 15.0;
        EXPECT_LE(static_cast<double>(with.candidates), 1.1 * most) << hint;
      }
    }
  }
}

/// A large group far away: two scenes in one, each of which is seen as finely as it is alone.
TEST(FarBodies, AreSeenAsFinelyAsThoseThatAreNear) {
  for (const double distance : {1e5, 1e6, 1e7}) {
    const std::size_t one = found_in(sheets_and_far(16, 1e-3, {}), Precision::full).candidates;
    FarScene two = sheets_and_far(16, 1e-3, {});
    const FarScene other = sheets_and_far(16, 1e-3, {});
    const int n = two.scene.n_vertices();
    for (int layer = 0; layer < 2; ++layer) {
      auto [vertices, triangles] = grid(16, 16, 1.0 / 16);
      for (std::size_t v = 0; v < vertices.size(); ++v) {
        const int from = layer * n / 2 + static_cast<int>(v);
        vertices[v] = other.scene.x0.col(from) + distance * Vec3d(1, 0.5, -0.3);
      }
      add_body(two.scene, "far", vertices, triangles, 0.01, false, 0.001);
    }
    const Positions moved = other.x1 - other.scene.x0;
    two.x1.conservativeResize(3, 2 * n);
    two.x1.rightCols(n) = two.scene.x0.rightCols(n) + moved;
    two.original.resize(at(2 * n), -1);
    const Found both = found_in(two, Precision::full);
    EXPECT_GE(both.candidates, 2 * one * 9 / 10) << distance;
    EXPECT_LE(both.candidates, 2 * one * 11 / 10) << distance;
  }
}

/// Of the candidates of a scene, how many are proven to be far.
double share_proven(const FarScene& far) {
  const Surface surface(far.scene);
  BroadPhase broad_phase(surface, {}, plan_contact(far.scene));
  Candidates candidates;
  broad_phase.update(far.scene.x0, far.scene.x0, candidates);
  FarTest test(surface);
  test.set_state(far.scene.x0);
  std::size_t proven = 0;
  for (std::size_t begin = 0; begin < candidates.edge_edge.size(); begin += FarTest::width) {
    const std::size_t n = std::min(FarTest::width, candidates.edge_edge.size() - begin);
    proven += static_cast<std::size_t>(
        std::popcount(test.far<PairKind::edge_edge>(&candidates.edge_edge[begin], n)));
  }
  return static_cast<double>(proven) / static_cast<double>(candidates.edge_edge.size());
}

TEST(FarBodies, LeaveNearlyAllFarPairsToTheFloats) {
  const double alone = share_proven(sheets_and_far(24, 1e-3, {}));
  EXPECT_GT(alone, 0.2);
  for (const FarBodies& bodies : far_cases()) {
    EXPECT_GT(share_proven(sheets_and_far(24, 1e-3, bodies)), 0.98 * alone) << bodies.distance;
  }
}

/// Groups of random size and place, sorted coordinates.
std::vector<double> groups(std::mt19937_64& rng, int n_groups) {
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<double> out;
  for (int g = 0; g < n_groups; ++g) {
    const double where = std::pow(10.0, 5 + 4 * unit(rng)) * unit(rng);
    for (int i = 0; i < 40; ++i) out.push_back(where + unit(rng));
  }
  std::sort(out.begin(), out.end());
  return out;
}

TEST(FoldedAxis, NeverTurnsAboutNorSpreadsApart) {
  std::mt19937_64 rng(5);
  int n_folded = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const std::vector<double> x = groups(rng, 1 + trial % 6);
    const auto count = [&](int) { return static_cast<int>(x.size()); };
    const auto frame = folded_frame([&](int, int i) { return x[at(i)]; }, count, 0.01);
    const FoldedAxis& axis = frame.axis[0];
    n_folded += axis.n > 1;
    std::vector<double> asked = x;
    std::uniform_real_distribution<double> between(1.2 * x.front() - 10, 1.2 * x.back() + 10);
    for (int i = 0; i < 200; ++i) asked.push_back(between(rng));
    for (int k = 1; k < axis.n; ++k) {
      for (const double step : {-1e-9, 0.0, 1e-9}) asked.push_back(axis.begin[k] + step);
    }
    std::sort(asked.begin(), asked.end());
    for (std::size_t i = 1; i < asked.size(); ++i) {
      const double way = asked[i] - asked[i - 1], moved = axis(asked[i]) - axis(asked[i - 1]);
      ASSERT_GE(moved, 0);
      // a float box makes up for the ulps of the places themselves
      const double rounding = place_rounding(asked[i], asked[i - 1], 0) + 0x1p-50 * std::abs(axis(asked[i]));
      ASSERT_LE(moved, way + rounding) << trial;
    }
  }
  EXPECT_GT(n_folded, 150);
}

TEST(FoldedAxis, LeavesAScenesOwnSizeAlone) {
  std::mt19937_64 rng(6);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<double> x;
  for (int i = 0; i < 60; ++i) x.push_back(unit(rng));
  for (int i = 0; i < 60; ++i) x.push_back(100 + unit(rng));  // not far: floats resolve both
  std::sort(x.begin(), x.end());
  const auto count = [&](int) { return static_cast<int>(x.size()); };
  const auto frame = folded_frame([&](int, int i) { return x[at(i)]; }, count, 0.01);
  EXPECT_EQ(frame.axis[0].n, 1);
  EXPECT_EQ(frame.axis[0](x[x.size() / 2]), 0);
}

}  // namespace
}  // namespace bb::test::far_bodies_test
