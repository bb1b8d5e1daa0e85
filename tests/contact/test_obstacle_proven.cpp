// The time before which planes prove a thick edge or triangle to stay above its stop level at a ball or a bar: never
// later than it comes there, and late enough to be of use.
#include <gtest/gtest.h>

#include "core/contact/obstacle_pair.hpp"
#include "core/contact/pair_geometry.hpp"
#include "tests/contact/close_bodies.hpp"

namespace bb::test::obstacle_proven_test {
namespace {

template <int N>
double proven(const Scene& scene, const TruePair& pair, const Positions& x0, const Positions& x1,
              double stop) {
  std::array<int, N> vertex;
  std::copy_n(pair.first.begin(), N, vertex.begin());
  const auto surface = analytic_surface<double>(scene.obstacles[at(pair.obstacle)]);
  return obstacle_proven_time<N, double>(surface, surface, gather(x0, vertex), gather(x1, vertex),
                                         pair.offset, stop, 1);
}

/// The first of 600 times at which the gap is below `level`; 2: none.
double first_below(const Scene& scene, const TruePair& pair, const Positions& x0, const Positions& x1,
                   double level) {
  for (int k = 0; k <= 600; ++k) {
    if (true_gap(scene, pair, x0 + k / 600.0 * (x1 - x0)) < level) return k / 600.0;
  }
  return 2;
}

TEST(ObstacleProven, IsNeverLaterThanTheStopLevelAndOftenTheWholeMotion) {
  int whole = 0, in_thickness = 0, cut = 0;
  for (unsigned seed = 1; seed <= 400; ++seed) {
    const Wall wall = seed % 3 == 0 ? Wall::ball : seed % 3 == 1 ? Wall::bar : Wall::tilted_bar;
    const Piece piece = seed % 2 ? Piece::edge : Piece::triangle;
    const CloseBodies bodies = close_to_wall(piece, wall, 0.005, seed);
    const Scene& scene = bodies.scene;
    for (const double way : {-0.02, 0.004, 0.006, 0.02, 0.5}) {
      const Positions x1 = approach(bodies, way, 0.1 * std::abs(way), seed);
      for (const TruePair& pair : bodies.pairs) {
        if (pair.first.size() < 2) continue;
        for (const double stop : {1e-8, 1e-3}) {
          const double time = pair.first.size() == 2 ? proven<2>(scene, pair, scene.x0, x1, stop)
                                                     : proven<3>(scene, pair, scene.x0, x1, stop);
          const double first = first_below(scene, pair, scene.x0, x1, stop);
          ASSERT_LE(std::min(time, 1.0), first) << seed << " " << way;
          whole += first > 1 && time >= 1;
          cut += first <= 1;
          // nothing of it comes to the obstacle itself: only the thickness does
          in_thickness += first <= 1 && first_below(scene, pair, scene.x0, x1, -pair.offset) > 1;
        }
      }
    }
  }
  EXPECT_GT(whole, 500);
  EXPECT_GT(cut, 500);
  EXPECT_GT(in_thickness, 300);
}

}  // namespace
}  // namespace bb::test::obstacle_proven_test
