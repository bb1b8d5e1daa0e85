// Obstacles whose numbers are large: the rounding that their size brings into a distance is part of the stop level, in
// double and in float, of edges and triangles alike.
#include <gtest/gtest.h>

#include "tests/contact/close_bodies.hpp"

namespace bb::test::far_axis_test {
namespace {

/// A body beside a bar whose point is `far` along its axis, or beside a ball whose centre is so far away.
CloseBodies at_far_obstacle(Piece piece, bool bar, double far, double gap, unsigned seed) {
  std::mt19937_64 rng(seed);
  CloseBodies out = close_to_wall(piece, Wall::tilted_bar, gap, seed);
  Obstacle& o = out.scene.obstacles[0];
  if (!bar) {
    o.kind = ObstacleKind::sphere;
    o.radius = far;
    o.point =
        out.scene.x0.rowwise().mean() + (far + 3) * Vec3d(in_box(rng, 1) + Vec3d(0.1, 0, 0)).normalized();
    out.pairs.clear();
    for (const TruePair& p : TruePairs(out.scene).pairs) out.pairs.push_back(p);
  } else {
    o.point += (rng() % 2 ? far : -far) * o.axis;
  }
  detail::bring_to(out, gap);
  out.scene.rest = out.scene.x0;
  return out;
}

double largest_number(const Scene& scene) {
  return std::max(scene.obstacles[0].point.cwiseAbs().maxCoeff(), scene.obstacles[0].radius);
}

double gap_of(const CloseBodies& bodies, const Positions& x) {
  return least_true_gap(bodies.scene, bodies.pairs, x);
}

struct Tally {
  int stopped = 0, above_park = 0;
};

/// The stop level is 16 ulps of the largest number, and the body stops there: no lower, and not much higher.
void expect_level(const CloseBodies& bodies, double gap, double epsilon, Precision precision, Tally& tally) {
  const double level = 16 * epsilon * largest_number(bodies.scene);
  const Positions& x0 = bodies.scene.x0;
  const Positions x1 = approach(bodies, 3 * gap, 0, 1);
  ContactOptions options;
  options.precision = precision;
  ContactSystem contacts(bodies.scene, options);
  contacts.update_candidates(x0, x1);
  const double alpha = contacts.step_bound(x0, x1).alpha;
  ASSERT_LT(alpha, 1);
  ASSERT_GT(alpha, 0);
  const double left = gap_of(bodies, x0 + alpha * (x1 - x0)),
               error = 6 * epsilon * largest_number(bodies.scene);
  EXPECT_GT(left, level - error) << "level " << level;
  EXPECT_LT(left, level + 3 * error) << "level " << level;
  ++tally.stopped;
  tally.above_park += level > 4e-8;
}

TEST(FarAxis, TheStopLevelIsThatOfTheLargestNumber) {
  Tally tally;
  unsigned seed = 1;
  for (const bool bar : {true, false}) {
    for (const double far : {3e7, 1e9}) {
      for (int k = 0; k < 20; ++k, ++seed) {
        const Piece piece = k % 2 ? Piece::edge : Piece::triangle;
        const double gap = 2000 * std::numeric_limits<double>::epsilon() * far;
        const CloseBodies bodies = at_far_obstacle(piece, bar, far, gap, seed);
        if (bodies.pairs[bodies.closest].first.size() < 2) continue;  // a vertex has a formula of its own
        if (std::abs(gap_of(bodies, bodies.scene.x0) / gap - 1) > 0.2) continue;
        expect_level(bodies, gap, std::numeric_limits<double>::epsilon(), Precision::full, tally);
      }
    }
  }
  EXPECT_GT(tally.stopped, 30);
  EXPECT_EQ(tally.above_park, tally.stopped);
}

TEST(FarAxis, InFloatThatIsSoForAnyScene) {
  Tally tally;
  for (unsigned seed = 1; seed <= 80; ++seed) {
    const double far = 300, epsilon = std::numeric_limits<float>::epsilon(), gap = 2000 * epsilon * far;
    CloseBodies bodies = at_far_obstacle(Piece::edge, true, far, gap, seed);
    round_state(Precision::single, bodies.scene.x0);
    for (Obstacle& o : bodies.scene.obstacles) {
      o.point = o.point.cast<float>().cast<double>();
      o.radius = static_cast<double>(static_cast<float>(o.radius));
    }
    if (bodies.pairs[bodies.closest].first.size() < 2) continue;
    expect_level(bodies, gap, epsilon, Precision::single, tally);
  }
  EXPECT_GT(tally.stopped, 10);
}

}  // namespace
}  // namespace bb::test::far_axis_test
