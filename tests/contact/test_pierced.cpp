// Starts in which a bar, or in the plane a disk, is in the middle of a triangle whose sides are far from it: refused where
// and only where a corner can move, wherever the obstacle is.
#include <gtest/gtest.h>

#include "tests/contact/close_bodies.hpp"
#include "tests/oracle/dense.hpp"

namespace bb::test::pierced_test {
namespace {

/// Whether the axis crosses the inside of a triangle, by the weights of the crossing.
bool crosses(const Obstacle& o, const Vec3d& axis, const Positions& x, const std::array<int, 3>& triangle) {
  MatXl a = MatXl::Zero(4, 4);
  for (int k = 0; k < 3; ++k) {
    a.block<3, 1>(0, k) = (x.col(triangle[at(k)]) - o.point).cast<long double>();
    a(3, k) = 1;
  }
  a.block<3, 1>(0, 3) = -axis.cast<long double>();
  const auto w = only_solution(a, VecXl::Unit(4, 3));
  return w && w->head<3>().minCoeff() > 0;
}

/// The bar of a scene goes through a triangle with a free corner.
bool pierced(const Scene& scene) {
  std::vector<std::uint8_t> free(at(scene.n_vertices()), 1);
  for (const Pin& pin : scene.pins) free[at(pin.vertex)] = 0;
  const Obstacle& o = scene.obstacles[0];
  const bool ball = o.kind == ObstacleKind::sphere;
  if (o.inside || o.kind == ObstacleKind::plane || (ball && !scene.planar)) return false;
  const auto triangles = scene.planar ? scene.membrane_triangles() : scene.surface_triangles;
  return std::any_of(triangles.begin(), triangles.end(), [&](const std::array<int, 3>& t) {
    const bool moves = std::any_of(t.begin(), t.end(), [&](int v) { return free[at(v)] != 0; });
    return moves && crosses(o, ball ? Vec3d::UnitZ() : o.axis, scene.x0, t);
  });
}

/// A triangle or a sheet and a thin obstacle near its middle, both far from the origin; corners are given as the bits of
/// `given` say.
Scene thin_at_the_middle(Piece piece, Wall wall, bool planar, unsigned given, unsigned seed) {
  std::mt19937_64 rng(seed);
  Scene scene;
  scene.planar = planar;
  add_piece(scene, piece, rng, 0.01, false);
  const Vec3d away = 5 * in_box(rng, 1, planar) + Vec3d(3, 2, 0);
  scene.x0.colwise() += away;
  scene.rest = scene.x0;
  Obstacle o = random_wall(wall, rng, planar);
  if (!o.inside) o.radius = between(rng, 0.001, 0.02);
  o.point = scene.x0.leftCols(3).rowwise().mean() + in_box(rng, 0.4, planar);
  if (!planar && o.kind == ObstacleKind::cylinder) o.point += between(rng, -20, 20) * o.axis;
  scene.obstacles = {o};
  for (int v = 0; v < scene.n_vertices(); ++v) {
    if ((given >> v & 1U) != 0) scene.pins.push_back({v, 0});
  }
  if (!scene.pins.empty()) scene.motions.push_back({});
  return scene;
}

struct Tally {
  int pierced = 0, valid = 0, by_gap = 0, partly_given = 0;
};

void expect_start(const Scene& scene, Tally& tally) {
  const auto all = TruePairs(scene).pairs;
  const double least = least_true_gap(scene, all, scene.x0);
  const bool through = pierced(scene);
  ContactSystem contacts(scene, {});
  const auto found = contacts.check_initial(scene.x0);
  ASSERT_EQ(found.has_value(), through || least <= 0)
      << "through " << through << " gap " << least << ", " << scene.pins.size() << " given";
  ++(least <= 0 ? tally.by_gap : through ? tally.pierced : tally.valid);
  if (least <= 0 || !through) return;
  EXPECT_EQ(found->kind, ContactKind::obstacle_triangle);
  EXPECT_EQ(found->gap, -scene.obstacles[0].radius);
  tally.partly_given += !scene.pins.empty();
}

TEST(Pierced, IsRefusedWhereACornerIsFreeWhereverTheObstacleIs) {
  for (const bool planar : {false, true}) {
    for (const Wall wall : {Wall::bar, Wall::tilted_bar, Wall::ball}) {
      if (planar && wall == Wall::tilted_bar) continue;
      Tally tally;
      for (unsigned seed = 1; seed <= 240; ++seed) {
        const Piece piece = seed % 2 ? Piece::triangle : Piece::sheet;
        expect_start(thin_at_the_middle(piece, wall, planar, seed % 16, seed), tally);
      }
      if (wall == Wall::ball && !planar) {  // a ball has no axis
        EXPECT_EQ(tally.pierced, 0);
        EXPECT_GT(tally.valid, 50);
        continue;
      }
      EXPECT_GT(tally.pierced, 30) << planar;
      EXPECT_GT(tally.partly_given, 20) << planar;
      EXPECT_GT(tally.valid, 30) << planar;
      EXPECT_GT(tally.by_gap, 10) << planar;
    }
  }
}

/// Inside of a wide ball or bar the axis may go through: that is no obstacle.
TEST(Pierced, TheAxisOfAnObstacleThatHoldsTheBodyIsFree) {
  Tally tally;
  for (const bool planar : {false, true}) {
    for (unsigned seed = 1; seed <= 40; ++seed)
      expect_start(
          thin_at_the_middle(Piece::triangle, seed % 2 ? Wall::in_bar : Wall::in_ball, planar, 0, seed),
          tally);
  }
  EXPECT_EQ(tally.valid, 80);
}

}  // namespace
}  // namespace bb::test::pierced_test
