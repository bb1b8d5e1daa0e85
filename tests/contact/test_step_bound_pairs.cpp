// The step bound queries few pairs for their time, and is that of querying every one; candidates up to it suffice.
#include <gtest/gtest.h>

#include "core/contact/candidates.hpp"
#include "core/contact/obstacle_pair.hpp"
#include "core/contact/pair_row.hpp"
#include "core/geometry/accd.hpp"
#include "tests/contact/bound_of.hpp"

namespace bb::test::step_bound_pairs_test {
namespace {

/// The bound that queries every candidate for its time, in their order.
StepBound every_candidate(const Scene& scene, const Positions& x1) {
  const Surface surface(scene);
  std::vector<AnalyticSurface<double>> obstacles;
  for (const Obstacle& o : scene.obstacles) obstacles.push_back(analytic_surface<double>(o));
  BroadPhase broad_phase(surface, obstacles, plan_contact(scene));
  Candidates candidates;
  broad_phase.update(scene.x0, x1, candidates);
  const ContactOptions options;
  StepBound out;
  const auto take = [&out](double toi, ContactKind kind, const ContactKey& key) {
    out.zero += toi == 0;
    if (!(toi < out.alpha)) return;
    out.alpha = toi;
    out.kind = kind;
    out.key = key;
  };
  for_each_kind(candidates, [&]<PairKind K>(const std::vector<IndexPair>& pairs) {
    for (const IndexPair index : pairs) {
      const ContactPair<K> pair = contact_pair<K>(surface, index);
      const auto r = accd<K, double>(gather(scene.x0, pair.vertex), gather(x1, pair.vertex), pair.law.offset,
                                     options.min_gap_fraction * pair.law.d_hat);
      ++out.queries;
      take(r.hit ? r.toi : 1, contact_kind<K>(), pair_key(pair.vertex));
    }
  });
  for_each_obstacle_list(
      surface, candidates, [&]<int N>(const Primitives<N>& primitives, const std::vector<IndexPair>& pairs) {
        for (const IndexPair index : pairs) {
          const auto& vertex = primitives.vertices[at(index.first)];
          const Side law = primitives.side[at(index.first)];
          const AnalyticSurface<double>& obstacle = obstacles[at(index.second)];
          const Mat<double, 3, N> from = gather(scene.x0, vertex), to = gather(x1, vertex);
          const double park = options.min_gap_fraction * law.d_hat;
          const auto kind = static_cast<ContactKind>(static_cast<int>(ContactKind::obstacle) + N - 1);
          if constexpr (N == 1) {
            take(obstacle_toi(obstacle, obstacle, from, to, law.offset, park), kind,
                 obstacle_key(index.second, vertex));
          } else {
            const auto r = obstacle_accd<N, double>(obstacle, obstacle, from, to, law.offset, park, 4096, 1);
            ++out.queries;
            take(r.hit ? r.toi : 1, kind, obstacle_key(index.second, vertex));
          }
        }
      });
  return out;
}

/// Counts into *bounded the motions that something stops.
void expect_that_of_every_candidate(const Scene& scene, const Positions& x1, int* bounded) {
  const StepBound expected = every_candidate(scene, x1), found = bound(scene, x1);
  EXPECT_EQ(found.alpha, expected.alpha);
  EXPECT_EQ(found.kind, expected.kind);
  EXPECT_EQ(found.key, expected.key);
  EXPECT_EQ(found.zero, expected.zero);
  EXPECT_EQ(found.capped, 0);
  EXPECT_LE(found.queries, expected.queries);
  *bounded += expected.alpha < 1;
}

TEST(StepBound, IsThatOfEveryCandidateOnRandomMotions) {
  int bounded = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    Scene scene;
    const auto [v1, t1] = soup(60, 0.2, seed);
    const auto [v2, t2] = soup(60, 0.2, seed + 100);
    add_body(scene, "a", v1, t1, 0.01, false, seed % 2 ? 0.001 : 0);
    add_body(scene, "b", v2, t2, 0.03, seed % 3 == 0);
    scene.obstacles.resize(3);
    scene.obstacles[0].point = Vec3d(0, 0, -1.3);
    scene.obstacles[1].kind = ObstacleKind::sphere;
    scene.obstacles[1].point = Vec3d(0, 0, 2.02);
    scene.obstacles[1].radius = 0.9;
    scene.obstacles[2].kind = ObstacleKind::cylinder;
    scene.obstacles[2].point = Vec3d(2.02, 0, 0);
    scene.obstacles[2].radius = 0.9;
    for (const double size : {0.3, 1e-2, 1e-4}) {
      expect_that_of_every_candidate(scene, random_motion(scene.x0, size, seed), &bounded);
    }
  }
  EXPECT_GE(bounded, 12);
}

/// A sheet of n x n cells over another, both wavy, that comes down on it while both slide.
std::pair<Scene, Positions> falling_cloth(int n, double sink) {
  Scene scene;
  const double h = 1.0 / n;
  auto [low, t1] = grid(n, n, h);
  auto [high, t2] = grid(n, n, h, Vec3d(0.3 * h, 0.2 * h, 0));
  for (Vec3d& p : low) p[2] = 0.1 * std::sin(7 * p[0]) * std::cos(5 * p[1]);
  for (Vec3d& p : high) p[2] = 0.1 * std::sin(7 * p[0]) * std::cos(5 * p[1]) + 0.6 * d_hat;
  add_body(scene, "low", low, t1, d_hat);
  const int first = add_body(scene, "high", high, t2, d_hat);
  Positions x1 = scene.x0;
  x1.row(0).array() += 0.3;
  for (int v = first; v < x1.cols(); ++v) x1(2, v) -= sink * (1 + std::sin(9 * x1(0, v)));
  return {scene, x1};
}

TEST(StepBound, IsThatOfEveryCandidateOnMovingCloth) {
  int bounded = 0;
  for (const double sink : {1e-3, 4e-3, 2e-2, 0.3}) {
    const auto [scene, x1] = falling_cloth(20, sink);
    expect_that_of_every_candidate(scene, x1, &bounded);
    EXPECT_GT(n_pairs(scene, x1), 10000U);
  }
  EXPECT_GE(bounded, 2);
  EXPECT_LT(bounded, 4);
}

/// Candidates up to the bound of a motion: as the motion's own, for the bound and for every state before it.
void expect_as_of_the_whole_motion(const Scene& scene, const Positions& x1, int* shortened,
                                   std::size_t* n_rows) {
  ContactSystem whole(scene, {}), part(scene, {});
  rows_at(part, scene.x0);
  whole.update_candidates(scene.x0, x1);
  part.update_candidates_to_bound(scene.x0, x1);
  const StepBound expected = whole.step_bound(scene.x0, x1), found = part.step_bound(scene.x0, x1);
  EXPECT_EQ(found.alpha, expected.alpha);
  EXPECT_EQ(found.kind, expected.kind);
  EXPECT_EQ(found.key, expected.key);
  for (const double share : {0.0, 0.5, 0.999, 1.0}) {
    const Positions x = scene.x0 + share * expected.alpha * (x1 - scene.x0);
    Rows all, few;
    all.min_gap = whole.find_rows(x, all.table, all.mollified);
    few.min_gap = part.find_rows(x, few.table, few.mollified);
    *n_rows += all.table.size();
    EXPECT_EQ(few.min_gap, all.min_gap);
    EXPECT_EQ(few.table.pair, all.table.pair);
    EXPECT_EQ(few.table.d, all.table.d);
    EXPECT_EQ(few.mollified.pair, all.mollified.pair);
  }
  const auto n = [](const ContactSystem& contacts) {
    return contacts.candidate_counts().point_triangle + contacts.candidate_counts().edge_edge;
  };
  EXPECT_LE(n(part), n(whole));
  *shortened += n(part) < n(whole);
}

TEST(StepBound, NeedsNoCandidateBeyondItself) {
  int shortened = 0;
  std::size_t n_rows = 0;
  for (const double sink : {1e-3, 4e-3, 0.3, 3.0}) {
    const auto [scene, x1] = falling_cloth(16, sink);
    expect_as_of_the_whole_motion(scene, x1, &shortened, &n_rows);
  }
  for (unsigned seed = 1; seed <= 4; ++seed) {
    Scene scene;
    const auto [v1, t1] = soup(150, 0.2, seed);
    add_body(scene, "a", v1, t1, 0.05);
    expect_as_of_the_whole_motion(scene, random_motion(scene.x0, 0.3, seed), &shortened, &n_rows);
  }
  EXPECT_GE(shortened, 3);
  EXPECT_GT(n_rows, 5000U);
}

/// A point that has a row at the start stops late; others come from afar: one stops first, one has a row by
/// then, one would arrive only after the first has stopped and is no candidate.
TEST(StepBound, ComesFromFarBodiesTooWhenANearOneStopsLater) {
  Scene scene;
  const auto [vertices, triangles] = grid(4, 4, 1.0);
  const int first = add_body(scene, "floor", vertices, triangles, d_hat, true) + 25;
  add_body(scene, "points",
           {Vec3d(0.7, 0.4, d_hat / 2), Vec3d(1.7, 0.4, 1), Vec3d(2.7, 0.4, 0.5), Vec3d(3.7, 0.4, 2)}, {},
           d_hat);
  Positions x1 = scene.x0;
  x1.row(2).tail(4) -= Eigen::RowVector4d(0.55 * d_hat, 1.25, 0.62, 2.05);
  int shortened = 0;
  std::size_t n_rows = 0;
  expect_as_of_the_whole_motion(scene, x1, &shortened, &n_rows);
  EXPECT_EQ(shortened, 1);
  const StepBound b = bound(scene, x1);
  EXPECT_NEAR(b.alpha, 0.8, 1e-6);
  EXPECT_EQ(b.key[3], first + 1);
}

TEST(StepBound, WithoutAnyRowKnownTheWholeMotionHasCandidates) {
  const auto [scene, x1] = falling_cloth(16, 0.3);
  ContactSystem contacts(scene, {});
  contacts.update_candidates_to_bound(scene.x0, x1);
  const ContactSystem::Counts counts = contacts.candidate_counts();
  EXPECT_EQ(counts.point_triangle + counts.edge_edge, n_pairs(scene, x1));
  EXPECT_EQ(contacts.step_bound(scene.x0, x1).alpha, bound(scene, x1).alpha);
}

TEST(StepBound, AsksFewOfTheCandidatesOfMovingCloth) {
  const auto [scene, x1] = falling_cloth(20, 0.3);
  const StepBound b = bound(scene, x1);
  EXPECT_LT(b.alpha, 0.1);
  EXPECT_GT(b.queries, 0);
  EXPECT_LT(10 * static_cast<std::size_t>(b.queries), n_pairs(scene, x1));
}

/// Every vertex of a flat sheet comes down to the plane below it at once: the first pair in the order of the
/// candidates is named, of thousands in several batches that tie.
TEST(StepBound, NamesTheFirstOfPairsThatTieInSeveralBatches) {
  Scene scene;
  const auto [low, t1] = grid(40, 40, 0.25);
  add_body(scene, "low", low, t1, d_hat, true);
  const auto [high, t2] = grid(40, 40, 0.25, Vec3d(0, 0, 0.125));
  const int first = add_body(scene, "high", high, t2, d_hat);
  Positions x1 = scene.x0;
  x1.rightCols(x1.cols() - first).row(2).array() -= 0.25;
  int bounded = 0;
  expect_that_of_every_candidate(scene, x1, &bounded);
  EXPECT_EQ(bounded, 1);
  EXPECT_GT(n_pairs(scene, x1), 20000U);
}

}  // namespace
}  // namespace bb::test::step_bound_pairs_test
