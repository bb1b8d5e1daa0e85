// Rest shapes at a time: films, factors, bodies that keep theirs.
#include <gtest/gtest.h>

#include "core/model/scene/moving_rest.hpp"

namespace bb::moving_rest_test {
namespace {

/// Two bodies of two vertices; the second grows along x by a film and shrinks by a factor.
Scene scene() {
  Scene out;
  out.rest.resize(3, 4);
  out.rest << 0, 1, 10, 12, 0, 0, 1, 1, 0, 0, 0, 0;
  Positions first = out.rest.rightCols(2), last = first;
  last.row(0) *= 3;
  const auto film = std::make_shared<const Film>(Film({0, 2}, {first, last}, FilmInterpolation::linear));
  out.rest_motions = {{2, 2, film, {{0, 1}, {1, 0.5}}}};
  return out;
}

TEST(MovingRest, IsTheFilmTimesTheFactor) {
  const Scene of = scene();
  MovingRest rest(of);
  ASSERT_TRUE(rest.moves());
  EXPECT_EQ(rest.start(), of.rest);
  EXPECT_TRUE(rest.move(0));
  EXPECT_EQ(rest.now(), of.rest);
  EXPECT_TRUE(rest.move(1));
  const Positions half = rest.now();  // half way of the film: twice as long, and half of that
  EXPECT_EQ(half.leftCols(2), of.rest.leftCols(2)) << "another body";
  EXPECT_NEAR((half.col(3) - half.col(2)).norm(), 2 * 2 * 0.5, 1e-15);
  EXPECT_TRUE(rest.move(5));
  EXPECT_NEAR((rest.now().col(3) - rest.now().col(2)).norm(), 2 * 3 * 0.5, 1e-15) << "held after its end";
  EXPECT_FALSE(rest.move(6)) << "nothing is left to change";
}

TEST(MovingRest, DoesNotMoveWhereNoBodySaysSo) {
  Scene of = scene();
  of.rest_motions.clear();
  EXPECT_FALSE(MovingRest(of).moves());
  EXPECT_FALSE(MovingRest().moves());
}

}  // namespace
}  // namespace bb::moving_rest_test
