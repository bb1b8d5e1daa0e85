// The contact model points: obstacles act on vertices, by the rows that loose vertices have, and surfaces on nothing.
#include <gtest/gtest.h>

#include "tests/contact/obstacle_scenes.hpp"

namespace bb::test::points_model_test {
namespace {

ContactOptions points() {
  ContactOptions options;
  options.model = ContactModel::points;
  return options;
}

/// A sheet over a ball, with a vertex within reach of it and the middle of a triangle deeper, and a second sheet close above.
Scene sheets_over_ball() {
  Scene scene;
  const auto [vertices, triangles] = grid(3, 3, 0.1, Vec3d(-0.1, -0.1, 0));
  const auto above = grid(3, 3, 0.1, Vec3d(-0.1, -0.1, 0.004)).first;
  add_body(scene, "sheet", vertices, triangles, 0.01, false, 0);
  add_body(scene, "upper", above, triangles, 0.01, false, 0);
  scene.obstacles = {round_obstacle(ObstacleKind::sphere, Vec3d(0, 0, -0.205), 0.2)};
  return scene;
}

TEST(PointsModel, HasTheRowsOfLooseVerticesAlone) {
  const Scene scene = sheets_over_ball();
  ContactSystem whole(scene, ContactOptions{}), alone(scene, points());
  const Rows all = rows_at(whole, scene.x0), rows = rows_at(alone, scene.x0);
  ASSERT_EQ(rows.table.size(), 2U);  // the middle of either sheet
  EXPECT_EQ(rows.mollified.size(), 0U);
  EXPECT_GT(all.table.size(), 10U);
  for (std::size_t r = 0; r < rows.table.size(); ++r) {
    EXPECT_EQ(rows.table.kind[r], ContactKind::obstacle);
    EXPECT_NEAR(rows.table.d[r], r == 0 ? 0.005 : 0.009, 1e-15);
  }
}

/// A motion that takes triangles through the ball and through each other, and no vertex to it, is not bounded; one of a vertex is.
TEST(PointsModel, BoundsMotionsOfVerticesAtObstacles) {
  Scene scene = sheets_over_ball();
  Positions off = scene.x0;
  off.row(0).array() += 0.05;  // the centre is between vertices now
  off.row(1).array() += 0.05;
  Positions through = off;
  through.row(2).array() -= 0.05;
  for (int v = 0; v < 9; ++v) through(2, v) -= 0.02 * (v % 2);
  ContactSystem contacts(scene, points());
  contacts.update_candidates(off, off);
  EXPECT_FALSE(contacts.check_initial(off));
  contacts.update_candidates(off, through);
  const StepBound vertices = contacts.step_bound(off, through);
  double least = std::numeric_limits<double>::infinity();
  for (int v = 0; v < 18; ++v) least = std::min(least, gap_of_point(scene.obstacles[0], through.col(v)));
  EXPECT_EQ(vertices.alpha == 1, least > 0) << vertices.alpha << " " << least;
  Positions hit = scene.x0;
  hit.row(2).array() -= 0.05;
  contacts.update_candidates(scene.x0, hit);
  EXPECT_NEAR(contacts.step_bound(scene.x0, hit).alpha, 0.1, 1e-3);
}

}  // namespace
}  // namespace bb::test::points_model_test
