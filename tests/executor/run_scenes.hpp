// Scenes that are in contact or soon will be: planar ones, rods and solids, what slides, bounces, moves, is driven and is held.
#pragma once

#include "core/model/mesh/solid_generators.hpp"
#include "tests/executor/system_cases.hpp"

namespace bb::test {

inline Method cubic() { return fixed_method("cubic", 20); }
inline Method rubbing(const std::string& law = "smoothed_coulomb", double mu = 0.3) {
  Method out = cubic();
  out.friction.law = law;
  out.friction.mu = mu;
  out.friction.eps_v = 0.02;
  return out;
}

inline BodySpec planar_sheet(const char* name, int n_x, int n_y, double width, double bottom) {
  BodySpec out;
  out.name = name;
  const double height = width / (n_x - 1) * (n_y - 1);
  out.mesh = grid_mesh(n_x, n_y, width, height);
  out.mesh.vertices.row(1).array() += bottom + 0.5 * height;
  out.material.density = 0.3;
  out.material.youngs = 100;
  out.d_hat = 0.02;
  return out;
}

/// Two strips in the plane: the lower one on a disk, the upper one, turned a little, on it.
inline Scene planar_strips(PlanarPairs pairs) {
  SceneBuilder builder("strips", true, Vec3d(0, -10, 0), "test");
  builder.set_planar_pairs(pairs);
  BodySpec lower = planar_sheet("lower", 6, 2, 0.5, 0.31);
  PinSpec ends;
  ends.indices = {0, 5};
  lower.pins = {ends};
  builder.add_body(lower);
  BodySpec upper = planar_sheet("upper", 4, 2, 0.2, 0.425);
  for (int i = 0; i < upper.mesh.vertices.cols(); ++i)
    upper.mesh.vertices(1, i) += 0.02 * upper.mesh.vertices(0, i);
  upper.velocity = Vec3d(0, -0.2, 0);
  builder.add_body(upper);
  Obstacle disk;
  disk.name = "disk";
  disk.kind = ObstacleKind::sphere;
  disk.radius = 0.3;
  builder.add_obstacle(disk);
  return builder.finish();
}

/// A rod and a block of two models that fall on a floor.
inline Scene rod_and_blocks() {
  SceneBuilder builder("rod and blocks", false, Vec3d(0, 0, -10), "test");
  BodySpec rod;
  rod.name = "rod";
  rod.mesh = rod_mesh(6, Vec3d(0, 0, 0.015), Vec3d(0.3, 0.02, 0.025));
  rod.material.line_density = 0.1;
  rod.material.rod_stretching = 30;
  rod.material.rod_bending = 1e-3;
  rod.d_hat = 0.02;
  PinSpec end;
  end.indices = {0};
  rod.pins = {end};
  builder.add_body(rod);
  for (const char* model : {"stable_neo_hookean", "corotational"}) {
    BodySpec block;
    block.name = model;
    block.mesh = solid_box_mesh({1, 2, 1}, Vec3d(0.1, 0.2, 0.1));
    block.mesh.vertices.row(1).array() += *model == 's' ? 0.4 : 0.8;
    block.mesh.vertices.row(2).array() += 0.065;
    block.material.solid_model = model;
    block.material.solid_youngs = 2e3;
    block.material.solid_density = 20;
    block.d_hat = 0.02;
    builder.add_body(block);
  }
  Obstacle floor;
  floor.name = "floor";
  builder.add_obstacle(floor);
  return builder.finish();
}

/// A cloth that touches plate and floor and is drawn over them.
inline Scene drawn_cloth() {
  Scene scene = touching(cloth_on_plate(), 0.012);
  scene.v0.row(0).array() += 0.3;
  for (const Pin& pin : scene.pins) scene.v0.col(pin.vertex).setZero();
  return scene;
}

/// Balls of solid that fall on a floor.
inline Scene bouncing() {
  SceneBuilder builder("bouncing", false, Vec3d(0, 0, -10), "test");
  for (const double e : {0.5, 1.0}) {
    BodySpec block;
    block.name = e < 1 ? "soft" : "hard";
    block.mesh = solid_box_mesh({1, 1, 1}, Vec3d(0.1, 0.1, 0.1));
    block.mesh.vertices.row(0).array() += 0.5 * e;
    block.mesh.vertices.row(2).array() += 0.075 + 0.01 * e;
    block.material.solid_youngs = 2e3;
    block.material.solid_density = 20;
    block.d_hat = 0.02;
    block.velocity = Vec3d(0.1, 0, -0.6);
    block.restitution = e;
    builder.add_body(block);
  }
  Obstacle floor;
  floor.name = "floor";
  builder.add_obstacle(floor);
  return builder.finish();
}

/// A cloth on a ball that pushes, a bar that turns and a floor that rises.
inline Scene cloth_on_moving(bool turns) {
  Scene plain = cloth_on_balls_and_bar();
  SceneBuilder builder("moving", false, Vec3d(0, 0, -10), "test");
  BodySpec cloth = cloth_spec(4, 0.128, 0.03);
  cloth.material.bending = 1e-3;
  cloth.offset = 0.002;
  builder.add_body(cloth);
  for (Obstacle o : plain.obstacles) {
    if (o.name == "left") o.motion.velocity = Vec3d(0.1, 0, 0.05);
    if (o.name == "near") o.motion.velocity = Vec3d(0, 0.1, 0.1);
    if (o.name == "bar") {
      o.motion.velocity = Vec3d(-0.1, 0, 0.1);
      o.motion.axis = Vec3d::UnitY();
      o.motion.center = o.point;
      o.motion.angular_velocity = turns ? 2 : 0;
    }
    builder.add_obstacle(o);
  }
  return builder.finish();
}

/// A cloth and a closed block, pulled, blown at, stitched together, under pressure, on springs of cloth.
inline Scene driven() {
  SceneBuilder builder("driven", false, Vec3d(0, 0, -10), "test");
  builder.set_air({0.4, 0.1, Vec3d(0.5, 0, 0), {{0, Vec3d(0.5, 0, 0)}, {1, Vec3d(-4, 3, 0)}}});
  builder.set_gravity({{0, Vec3d(0, 0, -10)}, {0.05, Vec3d(0, 1, -8)}});
  BodySpec cloth = cloth_spec(5, 0.015, 0.02);
  cloth.material.cloth_tension = 20, cloth.material.cloth_tension_growing = 5,
  cloth.material.cloth_compression = 2;
  cloth.material.cloth_creep = 2, cloth.material.cloth_yield = 1e-4;
  cloth.material.bending = 1e-3, cloth.material.bending_exponential = 1e-3;
  cloth.material.bending_creep = 3, cloth.material.membrane_creep = 3, cloth.material.membrane_yield = 1e-4;
  cloth.material.shrink_keys = {{0, 1}, {1, 0.5}};
  PinSpec& pull = cloth.pins.emplace_back();
  pull.indices = {0, 4};
  pull.pull = 2;
  pull.motion.velocity = Vec3d(0, 0, 0.5);
  builder.add_body(cloth);
  BodySpec block;
  block.name = "block";
  block.mesh = solid_box_mesh({1, 1, 1}, Vec3d(0.2, 0.2, 0.2));
  block.mesh.vertices.colwise() += Vec3d(1, 0, 0.3);
  block.material.solid_youngs = 500;
  block.material.solid_density = 10;
  block.pressure = 20;
  block.d_hat = 0.02;
  builder.add_body(block);
  builder.add_stitch({"cloth", "block", {24}, {0}, 3, 0.1}, "/stitches/0");
  Obstacle floor;
  floor.name = "floor";
  builder.add_obstacle(floor);
  return builder.finish();
}

/// A sheet whose rim is held, just above a floor.
inline Scene held_sheet() {
  SceneBuilder builder("held sheet", false, Vec3d(0, 0, -10), "test");
  BodySpec sheet = cloth_spec(5, 0.015, 0.02);
  sheet.material.bending = 1e-2;
  PinSpec rim;
  for (int v = 0; v < 25; ++v) {
    if (v % 5 == 0 || v % 5 == 4 || v < 5 || v >= 20) rim.indices.push_back(v);
  }
  sheet.pins = {rim};
  builder.add_body(sheet);
  Obstacle floor;
  floor.name = "floor";
  builder.add_obstacle(floor);
  return builder.finish();
}

/// A cloth whose corners rise and are let go after four steps.
inline Scene released() {
  SceneBuilder builder("released", false, Vec3d(0, 0, -10), "test");
  BodySpec cloth = cloth_spec(4, 0.02, 0.02);
  cloth.material.bending = 1e-3, cloth.material.bending_creep = 5;
  cloth.restitution = 0.5;
  PinSpec& pin = cloth.pins.emplace_back();
  pin.indices = {0, 3, 12};
  pin.motion.velocity = Vec3d(0, 0, 0.1);
  pin.span = {-1, 0.045};
  builder.add_body(cloth);
  Obstacle floor;
  floor.name = "floor";
  builder.add_obstacle(floor);
  return builder.finish();
}

}  // namespace bb::test
