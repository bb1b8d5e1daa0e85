// Two sheets that fall onto a floor and meet it in their third step, and what a scene can have beside that, one feature by one.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/model/mesh/solid_generators.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::test {

/// What a scene is made of before it is one.
struct FeatureScene {
  std::vector<BodySpec> bodies;
  std::vector<Obstacle> obstacles;
  std::vector<StitchSpec> stitches;
  Air air;
  VelocityDamping damping;
  std::vector<GravityKey> gravity;
  double friction = 0;

  Scene scene() const {
    SceneBuilder builder("features", false, Vec3d(0, 0, -10), "test");
    builder.set_gravity(gravity);
    builder.set_air(air);
    builder.set_damping(damping);
    for (const BodySpec& body : bodies) builder.add_body(body);
    for (const StitchSpec& stitch : stitches) builder.add_stitch(stitch, "/stitches/0");
    for (const Obstacle& obstacle : obstacles) builder.add_obstacle(obstacle);
    return builder.finish();
  }
};

/// Springs, weight and contact alone. The sheets come down by 0.015 m a step of 0.01 s; the lower one is within d_hat of the floor
/// after two of them.
inline FeatureScene falling_sheets() {
  FeatureScene out;
  for (int layer = 0; layer < 2; ++layer) {
    BodySpec sheet;
    sheet.name = "sheet" + std::to_string(layer);
    sheet.mesh = grid_mesh(3, 3, 1.0, 1.0);
    sheet.mesh.vertices.row(0) *= 1 + 0.03 * layer;  // vertices not above vertices
    sheet.mesh.vertices.row(2).array() += 0.075 + 0.06 * layer;
    sheet.material.model = "none";
    sheet.material.density = 0.3;
    sheet.material.springs = 20;
    sheet.velocity = Vec3d(0.4, 0.1, -1.5 - 0.5 * layer);
    sheet.d_hat = 0.05;
    out.bodies.push_back(sheet);
  }
  Obstacle floor;
  floor.name = "floor";
  out.obstacles.push_back(floor);
  return out;
}

/// A solid block beside the sheets, whose surface is closed.
inline BodySpec block_beside() {
  BodySpec block;
  block.name = "block";
  block.mesh = solid_box_mesh({1, 1, 1}, Vec3d(0.5, 0.4, 0.3));
  block.mesh.vertices.colwise() += Vec3d(3, 0, 0.225);
  block.velocity = Vec3d(0, 0, -1.5);
  block.material.model = "none";
  block.material.solid_youngs = 300;
  block.material.solid_density = 10;
  block.d_hat = 0.05;
  return block;
}

struct Feature {
  std::string name;
  std::function<void(FeatureScene&)> add;
  bool remembers = false;   // more than positions and velocities: a pull goes to where its vertex began
  bool takes_time = false;  // it depends on when a step is
};

inline PinSpec pin_of(int vertex) {
  PinSpec pin;
  pin.indices = {vertex};
  return pin;
}

inline const std::vector<Feature>& features() {
  static const std::vector<Feature> list = {
      {"membrane",
       [](FeatureScene& s) {
         s.bodies[0].material.model = "corotational";
         s.bodies[0].material.youngs = 30;
       }},
      {"cloth_springs",
       [](FeatureScene& s) {
         s.bodies[1].material.cloth_tension = 4;
         s.bodies[1].material.cloth_compression = 2;
       }},
      {"hinges", [](FeatureScene& s) { s.bodies[0].material.bending = 0.01; }},
      {"rods",
       [](FeatureScene& s) {
         s.bodies[1].mesh.segments = {{0, 3}, {3, 6}};
         s.bodies[1].material.rod_bending = 0.01;
         s.bodies[1].material.line_density = 0.1;
       }},
      {"tetrahedra", [](FeatureScene& s) { s.bodies.push_back(block_beside()); }},
      {"inflation",
       [](FeatureScene& s) {
         if (s.bodies.size() < 3) s.bodies.push_back(block_beside());
         s.bodies[2].pressure = 20;
       }},
      {"stitch",
       [](FeatureScene& s) {
         s.stitches.push_back({"sheet0", "sheet1", {4, 8}, {4, 8}, 3.0, 0.05});
       }},
      {"strain_limit",
       [](FeatureScene& s) {
         s.bodies[1].material.limit = StrainLimitSpec{0.001, 0.05};
       }},
      {"pull",
       [](FeatureScene& s) {
         PinSpec pull = pin_of(2);
         pull.pull = 30;
         s.bodies[1].pins.push_back(pull);
       },
       true},
      {"air_drag",
       [](FeatureScene& s) {
         s.air.normal = 0.8;
         s.air.tangential = 0.3;
         s.air.wind = Vec3d(0.5, 0, 0.2);
       }},
      {"friction", [](FeatureScene& s) { s.friction = 0.4; }},
      {"restitution", [](FeatureScene& s) { s.bodies[0].restitution = 0.5; }, true},
      {"damping",
       [](FeatureScene& s) {
         s.damping = {0.5, 0.01};
       }},
      {"a pin", [](FeatureScene& s) { s.bodies[1].pins.push_back(pin_of(0)); }},
      {"creep",
       [](FeatureScene& s) {
         s.bodies[0].material.bending = 0.01;
         s.bodies[0].material.bending_creep = 20;
         s.bodies[1].material.cloth_tension = 4;
         s.bodies[1].material.cloth_creep = 20;
       },
       true},
      {"a pin that is let go",
       [](FeatureScene& s) {
         PinSpec pin = pin_of(6);
         pin.span.release = 0.025;
         s.bodies[1].pins.push_back(pin);
       },
       true, true},
      {"a pin that holds later",
       [](FeatureScene& s) {
         PinSpec pin = pin_of(7);
         pin.span.hold = 0.025;
         s.bodies[0].pins.push_back(pin);
       },
       true, true},
      {"a pull that ends",
       [](FeatureScene& s) {
         PinSpec pull = pin_of(5);
         pull.pull = 30;
         pull.span.release = 0.03;
         s.bodies[0].pins.push_back(pull);
       },
       true, true},
      {"gravity and wind over time",
       [](FeatureScene& s) {
         s.gravity = {{0, Vec3d(0, 0, -10)}, {0.05, Vec3d(1, 0, -20)}};
         s.air.normal = 0.8;
         s.air.wind_keys = {{0, Vec3d(0, 0, 0)}, {0.05, Vec3d(3, 0, 0)}};
       },
       false, true},
      {"a pressure over time",
       [](FeatureScene& s) {
         if (s.bodies.size() < 3) s.bodies.push_back(block_beside());
         s.bodies[2].pressure = 0;
         s.bodies[2].pressure_keys = {{0, 10}, {0.02, 60}, {0.05, 0}};
       },
       false, true},
      {"an obstacle that turns and rises",
       [](FeatureScene& s) {
         s.friction = 0.4;
         Obstacle ball;
         ball.name = "ball";
         ball.kind = ObstacleKind::sphere;
         ball.point = Vec3d(0.5, 0.5, -0.3);
         ball.radius = 0.3;
         ball.motion.velocity = Vec3d(0, 0, 0.2);
         ball.motion.center = ball.point;
         ball.motion.angular_velocity = 3;
         s.obstacles.push_back(ball);
       },
       false, true}};
  return list;
}

}  // namespace bb::test
