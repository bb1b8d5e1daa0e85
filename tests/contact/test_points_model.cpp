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

/// A motion that takes the middle of a face into the ball, and no vertex to it, is bounded where surfaces count and not where points
/// alone do; one that takes a vertex into it is bounded by both.
TEST(PointsModel, BoundsMotionsOfVerticesAtObstacles) {
  const Scene scene = sheets_over_ball();
  Positions off = scene.x0;
  off.topRows(2).array() += 0.05;  // the top of the ball is below the middle of a face now
  Positions into = off;
  into.row(2).array() -= 0.012;
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index v = 0; v < into.cols(); ++v) {
    least = std::min(least, gap_of_point(scene.obstacles[0], into.col(v)));
  }
  ASSERT_GT(least, 1e-3) << "a vertex comes to the ball";
  ASSERT_LT(gap_of_point(scene.obstacles[0], Vec3d(0, 0, -0.012)), -5e-3) << "the face stays out of it";
  const auto bound = [&scene](const ContactOptions& options, const Positions& from, const Positions& to) {
    ContactSystem contacts(scene, options);
    contacts.update_candidates(from, to);
    return contacts.step_bound(from, to).alpha;
  };
  EXPECT_EQ(bound(points(), off, into), 1);
  EXPECT_LT(bound(ContactOptions{}, off, into), 0.5);
  Positions hit = scene.x0;
  hit.row(2).array() -= 0.05;
  EXPECT_NEAR(bound(points(), scene.x0, hit), 0.1, 1e-3);
}

}  // namespace
}  // namespace bb::test::points_model_test
