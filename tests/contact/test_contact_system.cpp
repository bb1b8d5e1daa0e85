// Feasibility of states, the check at scene load, and names.
#include <gtest/gtest.h>

#include "tests/contact/contact_scenes.hpp"

namespace bb::test::contact_system_test {
namespace {

Scene cloth_and_ball(double height) {
  Scene scene;
  const auto [vertices, triangles] = grid(2, 2, 1.0);
  add_body(scene, "cloth", vertices, triangles, 0.1);
  add_body(scene, "tip", {Vec3d(0.7, 0.4, height), Vec3d(0.7, 0.5, 1 + height), Vec3d(0.8, 0.4, 1 + height)},
           {{0, 1, 2}}, 0.1, true);
  return scene;
}

TEST(SmallestGap, IsPositiveUntilTheBodiesTouch) {
  const Scene scene = cloth_and_ball(0.05);
  ContactSystem contacts(scene, {});
  Positions touching = scene.x0;
  touching.rightCols(3).row(2).array() -= 0.05;
  contacts.update_candidates(scene.x0, touching);
  ContactTable rows;
  MollifiedTable mollified;
  EXPECT_GT(contacts.find_rows(scene.x0, rows, mollified), 0);
  EXPECT_LE(contacts.find_rows(touching, rows, mollified), 0);

  Positions broken = scene.x0;
  broken(0, 4) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_LE(contacts.find_rows(broken, rows, mollified), 0);
}

TEST(StepBound, OfAMotionThatIsNotFiniteIsNothing) {
  const Scene scene = cloth_and_ball(0.05);
  ContactSystem contacts(scene, {});
  contacts.update_candidates(scene.x0, scene.x0);
  EXPECT_EQ(contacts.step_bound(scene.x0, scene.x0).alpha, 1);
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Positions broken = scene.x0;
    broken(0, 4) = value;
    EXPECT_EQ(contacts.step_bound(scene.x0, broken).alpha, 0);
    EXPECT_EQ(contacts.step_bound(broken, scene.x0).alpha, 0);
  }
}

/// Two rods that cross at an angle of 0.04, and a particle over a plane that is closer or not.
TEST(SmallestGap, IsThatOfTheClosestRowOfEitherTable) {
  for (const double height : {0.02, 0.08}) {
    Scene scene;
    add_body(scene, "rod", {Vec3d(-0.5, 0, 5), Vec3d(0.5, 0, 5)}, {}, 0.1);
    add_body(scene, "other", {Vec3d(-0.5, -0.01, 5.05), Vec3d(0.5, 0.01, 5.05)}, {}, 0.1);
    scene.surface_edges = {{0, 1}, {2, 3}};
    add_body(scene, "particle", {Vec3d(0, 0, height)}, {}, 0.1);
    scene.surface_vertices = {4};  // the ends of the rods do not pair
    Obstacle plane;
    plane.name = "floor";
    scene.obstacles = {plane};
    ContactSystem contacts(scene, {});
    const Rows rows = rows_at(contacts, scene.x0);
    ASSERT_EQ(rows.mollified.size(), 1U);
    ASSERT_EQ(rows.table.size(), 1U);
    EXPECT_NEAR(rows.min_gap, std::min(0.05, height), 1e-12);

    Positions touching = scene.x0;  // the rods alone make a state infeasible
    touching.middleCols(2, 2).row(2).array() -= 0.05;
    EXPECT_LE(rows_at(contacts, touching).min_gap, 0);
  }
}

TEST(InitialCheck, NamesTheFirstPairThatTouches) {
  const Scene apart = cloth_and_ball(0.05);
  ContactSystem fine(apart, {});
  EXPECT_FALSE(fine.check_initial(apart.x0).has_value());

  Scene thick = apart;
  thick.offset.assign(thick.offset.size(), 0.03);
  ContactSystem overlapping(thick, {});
  const auto found = overlapping.check_initial(thick.x0);
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->gap, -0.01, 1e-15);
  EXPECT_EQ(found->kind, ContactKind::point_triangle);
  EXPECT_EQ(found->text, "point_triangle: cloth[0], cloth[1], cloth[4], tip[0]");
}

TEST(InitialCheck, TouchingIsNoValidStart) {
  Scene scene;
  const auto [vertices, triangles] = grid(2, 2, 1.0);
  add_body(scene, "cloth", vertices, triangles, 0.1);
  add_body(scene, "point", {Vec3d(1, 1, 0)}, {}, 0.1);  // exactly on a vertex
  ContactSystem touching(scene, {});
  ASSERT_TRUE(touching.check_initial(scene.x0).has_value());
  EXPECT_EQ(touching.check_initial(scene.x0)->gap, 0);

  Scene thick;
  add_body(thick, "point", {Vec3d(0, 0, 0.03)}, {}, 0.1, false, 0.02);
  thick.obstacles.push_back({});  // the plane z = 0
  ContactSystem above(thick, {});
  EXPECT_FALSE(above.check_initial(thick.x0).has_value());
  thick.offset = {0.04};
  ContactSystem inside(thick, {});
  ASSERT_TRUE(inside.check_initial(thick.x0).has_value());
  EXPECT_NEAR(inside.check_initial(thick.x0)->gap, -0.01, 1e-15);
}

TEST(InitialCheck, SeesObstaclesAndDescribesThemByName) {
  Scene scene = cloth_and_ball(0.05);
  Obstacle floor;
  floor.name = "floor";
  floor.point = Vec3d(0, 0, 1e-3);
  scene.obstacles.push_back(floor);
  ContactSystem contacts(scene, {});
  const auto found = contacts.check_initial(scene.x0);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->text, "obstacle: floor, cloth[0]");
  EXPECT_NEAR(found->gap, -1e-3, 1e-15);
}

}  // namespace
}  // namespace bb::test::contact_system_test
