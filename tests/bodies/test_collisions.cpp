// Choices of collision: names, groups, and what `auto` makes of open and closed surfaces.
#include <gtest/gtest.h>

#include "tests/bodies/bodies.hpp"

namespace bb::collisions_test {
namespace {

using namespace test;

BodySpec closed_ball(const std::string& name, double x) {
  BodySpec body;
  body.name = name;
  body.mesh = icosphere_mesh(1, 0.3);
  body.mesh.vertices.row(0).array() += x;
  body.d_hat = 0.01;
  return body;
}

Obstacle floor_below() {
  Obstacle floor;
  floor.name = "floor";
  floor.point = Vec3d(0, 0, -5);
  return floor;
}

/// Two balls, a cloth, a rigid box; a floor.
SceneBuilder all_kinds() {
  SceneBuilder builder("test", false, down, "test");
  builder.add_body(closed_ball("ball", 0));
  builder.add_body(closed_ball("other", 3));
  builder.add_body(cloth("cloth", 2));
  builder.add_body(rigid_box("box"));
  builder.add_obstacle(floor_below());
  return builder;
}

Collisions decided(const std::vector<CollisionSpec>& specs) {
  SceneBuilder builder = all_kinds();
  for (const CollisionSpec& spec : specs) builder.add_collision(spec, "/collisions");
  return builder.finish().collisions;
}

std::string refused(const std::vector<CollisionSpec>& specs) {
  try {
    decided(specs);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(Collisions, AutoFollowsOpenAndClosedSurfaces) {
  constexpr CollisionChoice by_surface = CollisionChoice::automatic;
  const Collisions of = decided({{"other", "ball", by_surface},
                                 {"cloth", "ball", by_surface},
                                 {"ball", "ball", by_surface},
                                 {"box", "ball", by_surface},
                                 {"ball", "floor", by_surface},
                                 {"floor", "cloth", by_surface}});
  EXPECT_EQ(of.kind(0, 1), CollisionKind::static_test);
  EXPECT_EQ(of.kind(0, 2), CollisionKind::audited);
  EXPECT_EQ(of.kind(0, 0), CollisionKind::audited);
  EXPECT_EQ(of.kind(0, 3), CollisionKind::static_test);
  EXPECT_EQ(of.kind(0, 4), CollisionKind::static_test) << "an obstacle is closed";
  EXPECT_EQ(of.kind(4, 2), CollisionKind::audited);
  EXPECT_EQ(of.find(0, 1)->reason, "auto: both surfaces are closed");
  EXPECT_EQ(of.find(0, 2)->reason, "auto: the surface of cloth is open");
  EXPECT_EQ(of.kind(1, 2), CollisionKind::ccd) << "nothing is reported of it";
  EXPECT_EQ(of.find(1, 2), nullptr);
}

TEST(Collisions, AreNotAuditedWhereTheStepSolverBoundsNoMotion) {
  SceneBuilder by_surface = all_kinds();
  by_surface.set_unbounded_motions("penalty");
  by_surface.add_collision({"cloth", "ball", CollisionChoice::automatic}, "/collisions/0");
  by_surface.add_collision({"ball", "ball", CollisionChoice::automatic}, "/collisions/1");
  by_surface.add_collision({"ball", "other", CollisionChoice::automatic}, "/collisions/2");
  const Collisions of = by_surface.finish().collisions;
  EXPECT_EQ(of.kind(0, 2), CollisionKind::ccd);
  EXPECT_EQ(of.kind(0, 0), CollisionKind::ccd);
  EXPECT_EQ(of.kind(0, 1), CollisionKind::static_test);
  EXPECT_EQ(of.find(0, 2)->reason,
            "auto: the surface of cloth is open; the step solver penalty bounds no motion");
  SceneBuilder given = all_kinds();
  given.set_unbounded_motions("penalty");
  given.add_collision({"cloth", "ball", CollisionChoice::audited}, "/collisions/0");
  try {
    given.finish();
    ADD_FAILURE() << "accepted";
  } catch (const ConfigError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("/collisions/0/kind"), std::string::npos) << text;
    EXPECT_NE(text.find("the step solver penalty bounds no motion"), std::string::npos) << text;
  }
}

TEST(Collisions, AreTakenAsGiven) {
  const Collisions of = decided({{"cloth", "cloth", CollisionChoice::off},
                                 {"cloth", "ball", CollisionChoice::proximity},
                                 {"cloth", "other", CollisionChoice::static_test},
                                 {"cloth", "box", CollisionChoice::ccd},
                                 {"ball", "other", CollisionChoice::audited}});
  EXPECT_EQ(of.kind(2, 2), CollisionKind::off);
  EXPECT_EQ(of.kind(2, 0), CollisionKind::proximity);
  EXPECT_EQ(of.kind(1, 2), CollisionKind::static_test);
  EXPECT_EQ(of.kind(2, 3), CollisionKind::ccd);
  EXPECT_EQ(of.kind(0, 1), CollisionKind::audited);
  EXPECT_TRUE(of.chosen());
  EXPECT_FALSE(decided({}).chosen());
}

TEST(Collisions, RefuseWhatMeansNothing) {
  constexpr CollisionChoice off = CollisionChoice::off;
  EXPECT_NE(refused({{"ball", "bal", off}})
                .find("the name of a body or an obstacle: ball, other, cloth, box, floor"),
            std::string::npos)
      << refused({{"ball", "bal", off}});
  EXPECT_NE(refused({{"ball", "cloth", off}, {"cloth", "ball", off}}).find("every pair once"),
            std::string::npos);
  EXPECT_NE(refused({{"box", "box", off}}).find("a vertex that moves freely"), std::string::npos);
  EXPECT_NE(refused({{"box", "floor", off}}).find("a vertex that moves freely"), std::string::npos);
}

TEST(Collisions, StatesAreTestedOnlyWhereThereAreTriangles) {
  SceneBuilder builder("test", false, down, "test");
  for (const char* name : {"rod", "other"}) {
    BodySpec rod;
    rod.name = name;
    rod.mesh = rod_mesh(4, Vec3d(0, 0, name[0] == 'r' ? 0 : 1), Vec3d(2, 0, 0));
    rod.material.line_density = 0.3;
    rod.material.springs = 50;
    rod.d_hat = 0.01;
    builder.add_body(rod);
  }
  builder.add_collision({"rod", "other", CollisionChoice::static_test}, "/collisions/0");
  try {
    builder.finish();
    ADD_FAILURE() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("neither surface has a triangle"), std::string::npos)
        << error.what();
  }
}

TEST(Collisions, GroupsAreNumberedAndAMovingObstacleIsMeantByItsName) {
  SceneBuilder builder("test", false, down, "test");
  BodySpec ball = closed_ball("ball", 0), sheet = cloth("cloth", 2);
  ball.collision_group = "solids";
  sheet.collision_group = "cloths";
  builder.add_body(ball);
  builder.add_body(sheet);
  Obstacle roller = floor_below();
  roller.name = "roller";
  roller.motion.velocity = Vec3d(1, 0, 0);
  roller.collision_group = "cloths";
  builder.add_obstacle(roller);
  builder.add_collision({"roller", "cloth", CollisionChoice::proximity}, "/collisions/0");
  const Scene scene = builder.finish();
  ASSERT_EQ(scene.bodies.size(), 3u) << "one stands for the obstacle";
  EXPECT_EQ(scene.collisions.kind(0, 1), CollisionKind::off);
  EXPECT_EQ(scene.collisions.kind(0, 3), CollisionKind::off) << "ball and roller";
  EXPECT_EQ(scene.collisions.kind(1, 3), CollisionKind::proximity);
  EXPECT_EQ(scene.collisions.kind(1, 1), CollisionKind::ccd);
}

}  // namespace
}  // namespace bb::collisions_test
