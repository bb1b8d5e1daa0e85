// The step bound of thick bodies of every kind that are close, against the distances of the whole surface by brute force:
// nothing comes nearer than the stop level before it, and something is at the stop level there.
#include <gtest/gtest.h>

#include "tests/contact/close_bodies.hpp"

namespace bb::test::close_bound_test {
namespace {

/// Where a pair is stopped (docs/theory/newton.md, Step bound), m.
double stop_of(const Scene& scene, const TruePair& pair, const Positions& x0, const Positions& x1) {
  constexpr double eps = std::numeric_limits<double>::epsilon();
  double largest = pair.offset;
  for (const auto* vertices : {&pair.first, &pair.second}) {
    for (const int v : *vertices)
      largest = std::max({largest, x0.col(v).cwiseAbs().maxCoeff(), x1.col(v).cwiseAbs().maxCoeff()});
  }
  if (pair.obstacle >= 0) {
    const Obstacle& o = scene.obstacles[at(pair.obstacle)];
    largest = std::max({largest, o.point.cwiseAbs().maxCoeff(), o.radius + pair.offset});
  }
  const double stop = std::max(1e-6 * pair.d_hat, 16 * eps * largest);
  const double start = true_gap(scene, pair, x0);
  return start < 2 * stop ? start / 2 : stop;
}

/// The least gap of all pairs beyond their stop levels on the motion up to the bound, sampled, and at the bound; m.
struct Margin {
  double before = std::numeric_limits<double>::infinity(), there = before;
};

Margin margin(const Scene& scene, const std::vector<TruePair>& pairs, const Positions& x1, double alpha) {
  const Positions& x0 = scene.x0;
  std::vector<double> stops;
  for (const TruePair& pair : pairs) stops.push_back(stop_of(scene, pair, x0, x1));
  Margin out;
  const auto least = [&](double t) {
    const Positions x = x0 + t * (x1 - x0);
    double m = std::numeric_limits<double>::infinity();
    for (std::size_t p = 0; p < stops.size(); ++p) m = std::min(m, true_gap(scene, pairs[p], x) - stops[p]);
    return m;
  };
  for (int k = 0; k <= 24; ++k) out.before = std::min(out.before, least(alpha * k / 24));
  for (double back = 0.02; back > 1e-9; back /= 4)
    out.before = std::min(out.before, least(alpha * (1 - back)));
  out.there = least(alpha);
  return out;
}

struct Tally {
  int scenes = 0, bounded = 0, free = 0, kinds[7] = {}, thick = 0, given = 0;
};

void expect_tight(const CloseBodies& bodies, const Positions& x1, Tally& tally) {
  const auto all = TruePairs(bodies.scene).pairs;  // of one body too
  if (least_true_gap(bodies.scene, all, bodies.scene.x0) <= 0) return;
  ContactSystem contacts(bodies.scene, {});
  contacts.update_candidates(bodies.scene.x0, x1);
  const StepBound bound = contacts.step_bound(bodies.scene.x0, x1);
  ASSERT_GT(bound.alpha, 0);
  ASSERT_EQ(bound.capped, 0);
  const Margin m = margin(bodies.scene, all, x1, bound.alpha);
  // rounding: of coordinates of about 10
  const double speed = (x1 - bodies.scene.x0).colwise().norm().maxCoeff();
  const double rounding = 2e-14 * (1 + speed);
  EXPECT_GT(m.before, -rounding) << "alpha " << bound.alpha;
  if (bound.alpha < 1) {
    EXPECT_LT(m.there, rounding) << "too timid: alpha " << bound.alpha;
  }
  ++tally.scenes;
  ++(bound.alpha < 1 ? tally.bounded : tally.free);
  if (bound.alpha < 1) ++tally.kinds[static_cast<int>(bound.kind)];
  const TruePair& pair = bodies.pairs[bodies.closest];
  tally.thick += pair.offset > 0 && bound.alpha < 1;
  tally.given += !bodies.scene.pins.empty() && bound.alpha < 1;
}

TEST(CloseBound, IsSafeAndNotTimidForThickBodiesOfEveryKind) {
  Tally tally;
  unsigned seed = 1;
  for_each_close_scene(40, 1, [&](const CloseBodies& bodies) {
    if (bodies.pairs.empty()) return;
    for (const double size : {1e-4, 0.01, 0.5}) {
      const double way = seed % 4 == 0 ? 0 : size * (seed % 3 + 0.1);
      const Positions x1 = approach(bodies, way, 0.3 * size, ++seed);
      expect_tight(bodies, x1, tally);
    }
  });
  EXPECT_GT(tally.scenes, 7000);
  EXPECT_GT(tally.bounded, 4000);
  EXPECT_GT(tally.free, 1000);
  EXPECT_GT(tally.thick, 3000);
  EXPECT_GT(tally.given, 500);
  for (const ContactKind kind :
       {ContactKind::point_edge, ContactKind::point_triangle, ContactKind::edge_edge, ContactKind::obstacle,
        ContactKind::obstacle_edge, ContactKind::obstacle_triangle})
    EXPECT_GT(tally.kinds[static_cast<int>(kind)], 20) << static_cast<int>(kind);
}

/// A body that was stopped goes on from there, as the next iteration does, and is never let through.
TEST(CloseBound, AStoppedBodyNeverGetsThroughHoweverOftenItIsPushed) {
  int pushed = 0;
  for_each_close_scene(6, 9000, [&](CloseBodies bodies) {
    if (bodies.pairs.empty()) return;
    for (int k = 0; k < 5; ++k, ++pushed) {
      const Positions x1 = approach(bodies, 0.3, 0.02, static_cast<unsigned>(pushed));
      ContactSystem contacts(bodies.scene, {});
      contacts.update_candidates(bodies.scene.x0, x1);
      const double alpha = contacts.step_bound(bodies.scene.x0, x1).alpha;
      bodies.scene.x0 += alpha * (x1 - bodies.scene.x0);
      ASSERT_GT(least_true_gap(bodies.scene, bodies.pairs, bodies.scene.x0), 0);
    }
  });
  EXPECT_GT(pushed, 300);
}

/// Pairs of one body may touch whatever the gap of the two is: all pairs are looked at.
TEST(CloseBound, TheStartIsValidWhileTheLeastGapIsPositive) {
  int valid = 0, overlapping = 0;
  for_each_close_scene(6, 17000, [&](CloseBodies bodies) {
    if (bodies.pairs.empty()) return;
    for (const double gap : {1e-8, -1e-8, -1e-4}) {
      detail::bring_to(bodies, gap);
      const auto all = TruePairs(bodies.scene).pairs;
      const double least = least_true_gap(bodies.scene, all, bodies.scene.x0);
      ContactSystem contacts(bodies.scene, {});
      const auto found = contacts.check_initial(bodies.scene.x0);
      ASSERT_EQ(found.has_value(), least <= 0) << least;
      ++(found ? overlapping : valid);
      if (found) {
        EXPECT_LE(found->gap, 0);
      }
    }
  });
  EXPECT_GT(valid, 100);
  EXPECT_GT(overlapping, 200);
}

}  // namespace
}  // namespace bb::test::close_bound_test
