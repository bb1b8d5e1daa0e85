// What planar_balanced promises beside the gap: of all planes that divide a pair's gap, its own lets the vertex that may go least go
// farthest. The best plane is found here by bisection in long double. The closest point is a corner or a side, so that other vertices
// lie farther back and have more way than the gap.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/contact/sampled_pairs.hpp"

namespace bb::test::balanced_plane_test {
namespace {

constexpr double size = 0.5;

/// Two primitives whose shortest way is along n; all but the closest vertices lie back by up to two gaps.
struct LyingBack {
  PairScene pair;
  Vec3d n;  // from the second to the first
};

LyingBack lying_back(Random& random, double gap) {
  const auto back = [&] { return gap * random.between(0.1, 2); };
  std::vector<Vec3d> first = {Vec3d(0, 0, gap)}, second = {Vec3d(0, 0, 0)};
  const int kind = static_cast<int>(random.rng() % 3);
  if (kind == 0) {  // the end of an edge, the end of another
    first.emplace_back(size, 0.3 * random.unit(), gap + back());
    second.emplace_back(0.3 * random.unit(), size, -back());
  } else if (kind == 1) {  // a point, a corner
    second.emplace_back(size, 0.3 * random.unit(), -back());
    second.emplace_back(0.3 * random.unit(), size, -back());
  } else {  // a point, a side
    second = {Vec3d(-size, 0, 0), Vec3d(size, 0, 0), Vec3d(0.3 * random.unit(), size, -back())};
  }
  const Eigen::AngleAxisd turn(random.between(0, 6), random.direction());
  LyingBack out;
  for (std::vector<Vec3d>* side : {&first, &second}) {
    for (Vec3d& x : *side) x = turn * x;
    const bool face = side->size() == 3;
    const int v = add_body(out.pair.scene, face || side == &second ? "second" : "first", *side,
                           face ? Triangles{{0, 1, 2}} : Triangles{}, d_hat);
    if (side->size() == 2) out.pair.scene.surface_edges.push_back({v, v + 1});
    if (face) out.pair.scene.surface_edges = {{v, v + 1}, {v + 1, v + 2}, {v, v + 2}};
  }
  out.pair.n = static_cast<int>(first.size() + second.size());
  out.pair.split = static_cast<int>(first.size());
  out.n = turn * Vec3d::UnitZ();
  return out;
}

/// The part that the vertex goes which goes least, where the plane gives `share` of the gap to the first side.
struct Divided {
  Long first = 1, second = 1;  // the least part of either side
  bool behind = false;         // the vertex of the second side that goes least lies back
};

Divided divided(const LyingBack& of, const Positions& x1, Long gap, Long share) {
  Divided out;
  const Positions& x = of.pair.scene.x0;
  for (int v = 0; v < of.pair.n; ++v) {
    const bool first = v < of.pair.split;
    const Long height =
        of.n.dot(x.col(v) - x.col(of.pair.split));  // over the closest point of the second side
    const Long way = (first ? -1 : 1) * of.n.dot(x1.col(v) - x.col(v));
    const Long behind = first ? height - gap : -height, room = behind + gap * (first ? share : 1 - share);
    if (!(way > 0)) continue;
    const Long part = gamma * room / way;
    Long& least = first ? out.first : out.second;
    if (part < least && !first) out.behind = behind > 0.01L * gap;
    least = std::min(least, part);
  }
  return out;
}

/// More of the gap lets the first side go farther, and the second less far.
Divided best(const LyingBack& of, const Positions& x1, Long gap) {
  Long low = 0, high = 1;
  for (int k = 0; k < 80; ++k) {
    const Long middle = (low + high) / 2;
    const Divided here = divided(of, x1, gap, middle);
    (here.first < here.second ? low : high) = middle;
  }
  return divided(of, x1, gap, (low + high) / 2);
}

TEST(BalancedPlane, LetsTheVertexThatMayGoLeastGoAsFarAsAnyPlaneDoes) {
  Random random(11);
  int bounded = 0, behind = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const double gap = random.between(0.1, 0.9) * d_hat;
    const LyingBack of = lying_back(random, gap);
    ASSERT_NEAR(of.pair.distance(of.pair.scene.x0), gap, 1e-12);
    Positions x1 = of.pair.scene.x0;
    for (int v = 0; v < of.pair.n; ++v)
      x1.col(v) += (v < of.pair.split ? -1 : 1) * gap * random.between(-0.2, 4) * of.n;
    const std::vector<double> parts = parts_of(of.pair.scene, x1, StepBoundRule::planar_balanced);
    const Divided wanted = best(of, x1, gap);
    const double least = static_cast<double>(std::min(wanted.first, wanted.second));
    ASSERT_NEAR(*std::min_element(parts.begin(), parts.end()), least, 1e-7) << trial;
    bounded += least < 1;
    behind += least < 1 && wanted.behind;
  }
  EXPECT_GT(bounded, 1000);
  EXPECT_GT(behind, 100) << "no vertex that lies back decides";
}

}  // namespace
}  // namespace bb::test::balanced_plane_test
