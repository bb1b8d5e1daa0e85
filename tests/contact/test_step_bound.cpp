// The largest collision-free step: never late on motions with a known time, tight, cheap for sliding pairs.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "core/contact/candidates.hpp"
#include "core/contact/contact_row.hpp"
#include "core/contact/obstacle_motion.hpp"
#include "core/contact/pair_name.hpp"
#include "core/geometry/accd.hpp"
#include "tests/contact/contact_scenes.hpp"

namespace bb::test {
namespace {

constexpr double d_hat = 0.01;

StepBound bound(const Scene& scene, const Positions& x1) {
  ContactSystem contacts(scene, {});
  contacts.update_candidates(scene.x0, x1);
  return contacts.step_bound(scene.x0, x1);
}

std::size_t n_pairs(const Scene& scene, const Positions& x1) {
  ContactSystem contacts(scene, {});
  contacts.update_candidates(scene.x0, x1);
  const ContactSystem::Counts counts = contacts.candidate_counts();
  return counts.point_point + counts.point_edge + counts.point_triangle + counts.edge_edge;
}

Scene point_above_floor(double height) {
  Scene scene;
  const auto [vertices, triangles] = grid(2, 2, 1.0);
  add_body(scene, "floor", vertices, triangles, d_hat, true);
  add_body(scene, "point", {Vec3d(0.7, 0.4, height)}, {}, d_hat);
  return scene;
}

TEST(StepBound, FallingPointStopsAtTheExactTime) {
  const Scene scene = point_above_floor(1);
  Positions x1 = scene.x0;
  x1(2, 9) = -1;
  const StepBound b = bound(scene, x1);
  const double park = 1e-6 * d_hat;
  EXPECT_LE(b.alpha, (1 - park) / 2);
  EXPECT_NEAR(b.alpha, (1 - park) / 2, 1e-12);
  EXPECT_EQ(b.kind, ContactKind::point_triangle);
  EXPECT_EQ(b.key[3], 9);
  EXPECT_GE(b.queries, 1);
  EXPECT_LE(b.probes, 4 * b.queries);
  EXPECT_EQ(b.zero, 0);
  EXPECT_EQ(b.capped, 0);
}

TEST(StepBound, CrossingEdgesStopAtTheExactTime) {
  Scene scene;
  add_body(scene, "a", {Vec3d(-1, 0, 0), Vec3d(1, 0, 0)}, {}, d_hat);
  add_body(scene, "b", {Vec3d(0, -1, 1), Vec3d(0, 1, 1)}, {}, d_hat);
  scene.surface_edges = {{0, 1}, {2, 3}};
  Positions x1 = scene.x0;
  x1.row(2) << 2, 2, -2, -2;
  const StepBound b = bound(scene, x1);
  EXPECT_LE(b.alpha, 0.2);
  EXPECT_NEAR(b.alpha, 0.2, 1e-8);
  EXPECT_EQ(b.kind, ContactKind::edge_edge);
  EXPECT_EQ(b.key, (ContactKey{0, 1, 2, 3}));
}

TEST(StepBound, OffsetsKeepTheSurfacesApart) {
  Scene scene = point_above_floor(1);
  scene.offset.assign(scene.offset.size(), 0.05);
  Positions x1 = scene.x0;
  x1(2, 9) = -1;
  EXPECT_NEAR(bound(scene, x1).alpha, 0.45, 1e-8);
  EXPECT_LE(bound(scene, x1).alpha, 0.45);
}

TEST(StepBound, SlidingAndSeparatingPairsAreFreeAndCheap) {
  Scene scene;
  const auto [v1, t1] = grid(12, 12, 0.1);
  const auto [v2, t2] = grid(12, 12, 0.1, Vec3d(0.03, 0.02, 1e-4));
  add_body(scene, "floor", v1, t1, d_hat, true);
  const int cloth = add_body(scene, "cloth", v2, t2, d_hat);
  Positions x1 = scene.x0;
  x1.rightCols(169).colwise() += Vec3d(0.25, 0.1, 0);
  const StepBound slide = bound(scene, x1);
  EXPECT_EQ(slide.alpha, 1);
  EXPECT_GT(n_pairs(scene, x1), 10000U);
  EXPECT_LT(50 * static_cast<std::size_t>(slide.queries), n_pairs(scene, x1));
  EXPECT_LE(slide.probes, 2 * slide.queries);

  x1 = scene.x0;
  x1.rightCols(169).colwise() += Vec3d(0.25, 0.1, 0.3);
  const StepBound separate = bound(scene, x1);
  EXPECT_EQ(separate.alpha, 1);
  EXPECT_LE(separate.probes, 2 * separate.queries);
  EXPECT_EQ(cloth, 169);
}

/// Two sheets within d_hat of each other, each moved as a whole.
struct TwoSheets {
  Scene scene;
  Positions x1;
  TwoSheets(const Vec3d& low, const Vec3d& high) {
    const auto [v1, t1] = grid(6, 6, 0.1);
    const auto [v2, t2] = grid(6, 6, 0.1, Vec3d(0.03, 0.02, d_hat / 2));
    add_body(scene, "low", v1, t1, d_hat);
    const int first = add_body(scene, "high", v2, t2, d_hat);
    x1 = scene.x0;
    x1.leftCols(first).colwise() += low;
    x1.rightCols(x1.cols() - first).colwise() += high;
  }
  std::size_t n_rows() const {  // none within a sheet: its points are 10 d_hat apart
    ContactSystem contacts(scene, {});
    return rows_at(contacts, scene.x0).table.size();
  }
};

TEST(StepBound, RigidMotionOfEverythingIsFreeAndHardlyAsksForAQuery) {
  const TwoSheets sheets({0.4, 0.3, 0.7}, {0.4, 0.3, 0.7});
  const StepBound b = bound(sheets.scene, sheets.x1);
  EXPECT_EQ(b.alpha, 1);
  EXPECT_GT(sheets.n_rows(), 50U);
  EXPECT_GT(n_pairs(sheets.scene, sheets.x1), 1000U);
  EXPECT_LT(100 * static_cast<std::size_t>(b.queries), n_pairs(sheets.scene, sheets.x1));
  EXPECT_EQ(b.probes, b.queries);
}

TEST(StepBound, BodiesThatPartHardlyAskForAQuery) {
  const TwoSheets sheets({-0.4, -0.3, -0.7}, {0.4, 0.3, 0.7});
  const StepBound b = bound(sheets.scene, sheets.x1);
  EXPECT_EQ(b.alpha, 1);
  EXPECT_GT(sheets.n_rows(), 50U);
  EXPECT_GT(n_pairs(sheets.scene, sheets.x1), 1000U);
  EXPECT_LT(100 * static_cast<std::size_t>(b.queries), n_pairs(sheets.scene, sheets.x1));
}

TEST(StepBound, PairsThatHaveNoRowStillBound) {
  // one body, closer at rest than d_hat: its row is shortened, its collision is not ignored
  Scene scene;
  add_body(scene, "body", {Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0.2, 0.2, 0.006)},
           {{0, 1, 2}}, d_hat);
  Positions x1 = scene.x0;
  x1(2, 3) = -0.006;
  const StepBound b = bound(scene, x1);
  EXPECT_LT(b.alpha, 0.5);
  EXPECT_NEAR(b.alpha, 0.5, 1e-5);
}

TEST(StepBound, ObstaclesBoundFreeVertices) {
  Scene scene;
  add_body(scene, "point", {Vec3d(0, 0, 1), Vec3d(5, 0, 1)}, {}, d_hat);
  scene.obstacles.push_back({});  // the plane z = 0
  Obstacle sphere;
  sphere.name = "ball";
  sphere.kind = ObstacleKind::sphere;
  sphere.point = Vec3d(5, 0, -1);
  sphere.radius = 1.5;
  scene.obstacles.push_back(sphere);
  Positions x1 = scene.x0;
  x1.row(2).array() -= 1;
  ContactSystem contacts(scene, {});
  contacts.update_candidates(scene.x0, x1);
  const StepBound b = contacts.step_bound(scene.x0, x1);
  EXPECT_LE(b.alpha, 0.5);
  EXPECT_NEAR(b.alpha, 0.5, 1e-7);
  EXPECT_EQ(b.kind, ContactKind::obstacle);
  EXPECT_EQ(b.key, (ContactKey{-1, -1, -3, 1}));
  EXPECT_EQ(pair_name(scene, b.key, b.kind), "obstacle: ball, point[1]");
}

TEST(StepBound, NamesTheFirstOfTheContactsThatLimitAlikeAndNoneOfAFreeMotion) {
  Scene scene;
  add_body(scene, "points", {Vec3d(0, 0, 1), Vec3d(1, 0, 1), Vec3d(2, 0, 1)}, {}, 0.1);
  scene.obstacles.push_back({});  // the plane z = 0
  ContactSystem contacts(scene, {});
  const auto bound = [&](double fall) {
    Positions x1 = scene.x0;
    x1.row(2).array() -= fall;
    contacts.update_candidates(scene.x0, x1);
    return contacts.step_bound(scene.x0, x1);
  };
  const StepBound stopped = bound(2);
  EXPECT_NEAR(stopped.alpha, 0.5, 1e-6);
  EXPECT_EQ(stopped.key, (ContactKey{-1, -1, -2, 0}));
  const StepBound free = bound(0.95);
  EXPECT_EQ(free.alpha, 1);
  EXPECT_EQ(free.key, (ContactKey{-1, -1, -1, -1}));
}

TEST(StepBound, ZeroIsCountedWhenThePairTouchesAtTheStart) {
  const Scene scene = point_above_floor(0);
  Positions x1 = scene.x0;
  x1(2, 9) = -1;
  const StepBound b = bound(scene, x1);
  EXPECT_EQ(b.alpha, 0);
  EXPECT_GE(b.zero, 1);
}

TEST(StepBound, RoundedStatesStayFeasibleOnRandomMotions) {
  int bounded = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    Scene scene;
    const auto [v1, t1] = soup(40, 0.2, seed);
    const auto [v2, t2] = soup(40, 0.2, seed + 100);
    add_body(scene, "a", v1, t1, 0.01);
    add_body(scene, "b", v2, t2, 0.01);
    ContactSystem contacts(scene, {});
    const Positions x1 = random_motion(scene.x0, 0.3, seed);
    contacts.update_candidates(scene.x0, x1);
    const StepBound b = contacts.step_bound(scene.x0, x1);
    EXPECT_GT(b.alpha, 0);
    bounded += b.alpha < 1;
    ContactTable rows;
    MollifiedTable mollified;
    for (double fraction : {0.25, 0.5, 0.999, 1.0}) {
      const Positions x = scene.x0 + fraction * b.alpha * (x1 - scene.x0);
      EXPECT_GT(contacts.find_rows(x, rows, mollified), 0);
    }
  }
  EXPECT_GE(bounded, 5);
}

TEST(StepBound, SameForAnyNumberOfThreads) {
  Scene scene;
  const auto [v1, t1] = soup(200, 0.2, 1);
  add_body(scene, "a", v1, t1, 0.01);
  scene.obstacles.push_back({});
  scene.obstacles[0].point = Vec3d(0, 0, -5);
  const Positions x1 = random_motion(scene.x0, 0.2, 4);
  StepBound reference;
  for (std::size_t threads : {1, 2, 5}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    const StepBound b = bound(scene, x1);
    if (threads == 1) reference = b;
    EXPECT_EQ(b.alpha, reference.alpha);
    EXPECT_EQ(b.key, reference.key);
    EXPECT_EQ(b.queries, reference.queries);
    EXPECT_EQ(b.probes, reference.probes);
  }
  EXPECT_LT(reference.alpha, 1);
  EXPECT_GT(reference.queries, 10);
}

/// The bound that asks every candidate for its time, in their order.
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
                                     options.ccd_park * pair.law.d_hat);
      ++out.queries;
      take(r.hit ? r.toi : 1, contact_kind<K>(), pair_key(pair.vertex));
    }
  });
  for (const IndexPair index : candidates.obstacle) {
    const int v = surface.points.vertices[at(index.first)][0];
    const Side law = surface.points.side[at(index.first)];
    take(obstacle_toi(obstacles[at(index.second)], scene.x0.col(v), x1.col(v), law.offset,
                      options.ccd_park * law.d_hat),
         ContactKind::obstacle, obstacle_key(index.second, v));
  }
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
    scene.obstacles.push_back({});
    scene.obstacles[0].point = Vec3d(0, 0, -1.3);
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
    EXPECT_EQ(few.table.key, all.table.key);
    EXPECT_EQ(few.table.d, all.table.d);
    EXPECT_EQ(few.table.multiplicity, all.table.multiplicity);
    EXPECT_EQ(few.mollified.key, all.mollified.key);
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

TEST(StepBound, PlanarPairsAreBoundedToo) {
  for (PlanarPairs pairs : {PlanarPairs::vertex_vertex, PlanarPairs::point_edge}) {
    Scene scene;
    scene.planar = true;
    scene.planar_pairs = pairs;
    add_body(scene, "wall", {Vec3d(0, 0, 0), Vec3d(1, 0, 0)}, {}, d_hat, true);
    scene.surface_edges = {{0, 1}};
    const bool edge = pairs == PlanarPairs::point_edge;
    add_body(scene, "point", {Vec3d(edge ? 0.5 : 0.0, 1, 0)}, {}, d_hat);
    Positions x1 = scene.x0;
    x1(1, 2) = -1;
    const StepBound b = bound(scene, x1);
    EXPECT_LT(b.alpha, 0.5);
    EXPECT_NEAR(b.alpha, 0.5, 1e-7);
    EXPECT_EQ(b.kind, edge ? ContactKind::point_edge : ContactKind::point_point);
  }
}

}  // namespace
}  // namespace bb::test
