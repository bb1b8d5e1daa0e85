// What a step bound says is of its own motion: none of its counters depends on the motions before.
#include <gtest/gtest.h>

#include "tests/contact/close_bodies.hpp"

namespace bb::test::bound_counters_test {
namespace {

struct Tally {
  int by_near_pairs = 0, free = 0, with_queries = 0;
};

/// Candidates and bound of one motion, as an iteration computes them.
StepBound bound_of(ContactSystem& contacts, const Positions& x0, const Positions& x1, bool to_bound) {
  if (to_bound) {
    contacts.update_candidates_to_bound(x0, x1);
  } else {
    contacts.update_candidates(x0, x1);
  }
  return contacts.step_bound(x0, x1);
}

void expect_same(const StepBound& found, const StepBound& expected, int k) {
  EXPECT_EQ(found.alpha, expected.alpha) << k;
  EXPECT_EQ(found.queries, expected.queries) << k;
  EXPECT_EQ(found.probes, expected.probes) << k;
  EXPECT_EQ(found.capped, expected.capped) << k;
  EXPECT_EQ(found.zero, expected.zero) << k;
  EXPECT_EQ(found.key, expected.key) << k;
}

/// A system that has seen motions of every kind, and one that has only found the rows of this state.
void expect_no_memory(const Scene& scene, unsigned seed, Tally& tally) {
  std::mt19937_64 rng(seed);
  ContactSystem used(scene, {});
  for (int k = 0; k < 8; ++k) {
    const double size = std::pow(10.0, between(rng, -7, 0));
    const Positions x1 = random_motion(scene.x0, size, seed * 10 + static_cast<unsigned>(k));
    const bool to_bound = rng() % 3 != 0;
    ContactSystem fresh(scene, {});
    rows_at(used, scene.x0);
    rows_at(fresh, scene.x0);
    const StepBound expected = bound_of(fresh, scene.x0, x1, to_bound);
    expect_same(bound_of(used, scene.x0, x1, to_bound), expected, k);
    // once more without rows in between, and with the other candidates before it
    bound_of(used, scene.x0, x1, !to_bound);
    expect_same(bound_of(used, scene.x0, x1, to_bound), expected, k);
    tally.by_near_pairs += to_bound && expected.alpha < 1;
    tally.free += expected.alpha == 1;
    tally.with_queries += expected.queries > 0;
  }
}

TEST(BoundCounters, AreThoseOfTheMotionWhateverWasAskedBefore) {
  Tally tally;
  for (unsigned seed = 1; seed <= 40; ++seed) expect_no_memory(mixed_scene(seed, seed % 4 == 0), seed, tally);
  EXPECT_GT(tally.by_near_pairs, 50);
  EXPECT_GT(tally.free, 30);
  EXPECT_GT(tally.with_queries, 100);
}

/// A motion that near pairs stop, then one that they leave alone: nothing of the first one is left.
TEST(BoundCounters, OfAFreeMotionAfterAStoppedOneAreItsOwn) {
  int judged = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const CloseBodies bodies = close_bodies(Piece::triangle, Piece::edge, 1e-3, seed);
    const Positions &x0 = bodies.scene.x0, towards = approach(bodies, 0.02, 0, seed),
                    apart = approach(bodies, -0.02, 0, seed);
    ContactSystem contacts(bodies.scene, {});
    if (rows_at(contacts, x0).table.size() == 0) continue;
    const StepBound free = bound_of(contacts, x0, apart, true);
    const StepBound stopped = bound_of(contacts, x0, towards, true);
    ASSERT_LT(stopped.alpha, 1);
    ASSERT_GT(stopped.queries, free.queries);
    expect_same(bound_of(contacts, x0, apart, true), free, 0);
    expect_same(bound_of(contacts, x0, towards, true), stopped, 1);
    expect_same(bound_of(contacts, x0, apart, false), free, 2);
    ++judged;
  }
  EXPECT_GT(judged, 30);
}

}  // namespace
}  // namespace bb::test::bound_counters_test
