// The rest rule of thick bodies: two thirds of the GAP at rest, thickness taken off, below 1.5 d_hat of it and above 0;
// every kind of pair of one body, on either side of both thresholds.
#include <gtest/gtest.h>

#include "tests/contact/close_bodies.hpp"

namespace bb::test::thick_rest_test {
namespace {

/// One body of two pieces whose least gap at rest is `gap`: that of two bodies, called one.
CloseBodies one_body(Piece a, Piece b, double gap, unsigned seed, bool planar) {
  CloseBodies out = close_bodies(a, b, gap, seed, planar);
  out.scene.pins.clear();
  out.scene.body.assign(at(out.scene.n_vertices()), 0);
  out.scene.bodies = {{"one", 0, out.scene.n_vertices()}};
  return out;
}

/// Of a pair of one body at rest.
double expected_d_hat(const TruePair& pair, double rest_gap) {
  return rest_gap > 0 && rest_gap < 1.5 * pair.d_hat ? rest_gap / 1.5 : pair.d_hat;
}

struct Tally {
  int shortened = 0, whole = 0, overlapping = 0, decided_by_thickness = 0, kinds[4] = {};
};

/// The closest pair comes so near that it has a row, and its d_hat is what the gap at rest says.
void expect_closest(const CloseBodies& bodies, Tally& tally) {
  const Scene& scene = bodies.scene;
  const TruePair& pair = bodies.pairs[bodies.closest];
  const double rest = true_gap(scene, pair, scene.rest), expected = expected_d_hat(pair, rest);
  CloseBodies near = bodies;
  detail::bring_to(near, 0.1 * expected);
  const double gap = true_gap(scene, pair, near.scene.x0);
  if (gap > 0.5 * expected) return;  // another pair is in front of it now
  ContactSystem contacts(scene, {});
  const Rows rows = rows_at(contacts, near.scene.x0);
  int found = 0;
  const auto look = [&](const auto& table) {
    for (std::size_t r = 0; r < table.size(); ++r)
      found += std::abs(table.d[r] - gap) < 1e-12 && std::abs(table.d_hat[r] - expected) < 1e-12;
  };
  look(rows.table);
  look(rows.mollified);
  EXPECT_GE(found, 1) << "gap at rest " << rest << ", d_hat " << pair.d_hat << ", thickness " << pair.offset;
  const bool shorter = expected < pair.d_hat;
  ++(rest <= 0 ? tally.overlapping : shorter ? tally.shortened : tally.whole);
  const double distance = rest + pair.offset;  // what it would be without thickness
  tally.decided_by_thickness += std::abs(expected_d_hat(pair, distance) - expected) > 1e-6;
  ++tally.kinds[pair.first.size() + pair.second.size() - 2];
}

TEST(ThickRest, DHatFollowsTheGapBetweenThicknesses) {
  Tally tally;
  unsigned seed = 1;
  for (const bool planar : {false, true}) {
    for (const Piece a : all_pieces) {
      for (const Piece b : all_pieces) {
        if (a > b || b == Piece::point) continue;
        for (const double part : {-0.3, -1e-4, 1e-3, 0.2, 0.8, 1.4, 1.6, 3.0}) {
          for (int k = 0; k < 4; ++k) {
            const CloseBodies probe = one_body(a, b, 0.001, ++seed, planar);
            if (probe.pairs.empty()) continue;
            const double d_hat = probe.pairs[probe.closest].d_hat;
            const CloseBodies bodies = one_body(a, b, part * d_hat, seed, planar);
            if (least_true_gap(bodies.scene, bodies.pairs, bodies.scene.x0) < 2 * part * d_hat + 1e-4)
              expect_closest(bodies, tally);
          }
        }
      }
    }
  }
  EXPECT_GT(tally.shortened, 150);
  EXPECT_GT(tally.whole, 100);
  EXPECT_GT(tally.overlapping, 50);
  EXPECT_GT(tally.decided_by_thickness, 150);
  EXPECT_GT(tally.kinds[1], 50);  // vertices and edges
  EXPECT_GT(tally.kinds[2], 100);
}

/// At rest no pair of one thick body has a row, unless its surfaces touch there: it would press on itself.
TEST(ThickRest, AThickBodyAtRestDoesNotPress) {
  int apart = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const Piece a = all_pieces[1 + seed % 4], b = all_pieces[1 + seed / 4 % 4];
    const double part = 0.05 * (1 + seed % 28);
    const CloseBodies bodies = one_body(std::min(a, b), std::max(a, b), part * 0.01, seed, seed % 5 == 0);
    const auto all = TruePairs(bodies.scene).pairs;
    if (bodies.pairs.empty() || least_true_gap(bodies.scene, all, bodies.scene.x0) <= 0) continue;
    ContactSystem contacts(bodies.scene, {});
    std::size_t n = 1;
    EXPECT_EQ(barrier(contacts, bodies.scene.rest, 1, TestShape::cubic, &n), 0) << seed;
    EXPECT_EQ(n, 0U) << seed;
    apart += bodies.pairs[bodies.closest].offset > 0;
  }
  EXPECT_GT(apart, 20);
}

}  // namespace
}  // namespace bb::test::thick_rest_test
