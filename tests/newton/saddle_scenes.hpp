// Sheets that two rows of vertices drive together in their plane, between two planes that they touch: flat, such a
// sheet is a saddle of E, or a minimum where it is driven apart.
#pragma once

#include <cmath>
#include <random>

#include "tests/newton/small_scenes.hpp"

namespace bb::test {

struct SheetCase {
  double speed = 0.2;        // m/s of either side, inwards where positive
  double jitter = 0;         // m, of the free start coordinates, out of the plane
  double thickness = 0.002;  // m, offset of the sheet
  double gap = 0.004;        // m between its surface and either plane; d_hat is 0.01 m
  bool only_floor = false;
  bool plates = false;    // thin rigid sheets in the place of the planes
  bool far_body = false;  // a rigid body 1e10 m away
  unsigned seed = 1;
};

constexpr double sheet_dt = 0.1;  // s
constexpr int sheet_side = 7;     // vertices

inline void add_plane(SceneBuilder& builder, const char* name, double z, double up) {
  Obstacle plane;
  plane.name = name;
  plane.point = Vec3d(0, 0, z);
  plane.axis = Vec3d(0, 0, up);
  builder.add_obstacle(plane);
}

inline BodySpec rigid_sheet(const char* name, const Vec3d& place) {
  BodySpec out = cloth_spec(3, 0, 0.01);
  out.name = name;
  out.kind = BodyKind::rigid;
  out.mesh.vertices *= 1.2;
  out.mesh.vertices.colwise() += place;
  return out;
}

inline Scene driven_sheet(const SheetCase& given) {
  SceneBuilder builder("driven sheet", false, Vec3d::Zero(), "test");
  BodySpec sheet = cloth_spec(sheet_side, 0, 0.01);
  sheet.name = "sheet";
  sheet.offset = given.thickness;
  sheet.material.youngs = 250;
  sheet.material.density = 0.15;
  sheet.material.bending = 1e-5;
  for (const double side : {-0.5, 0.5}) {
    PinSpec pins;
    for (int v = 0; v < sheet.mesh.vertices.cols(); ++v) {
      if (std::abs(sheet.mesh.vertices(0, v) - side) < 1e-6) pins.indices.push_back(v);
    }
    pins.motion.velocity = Vec3d(side > 0 ? -given.speed : given.speed, 0, 0);
    sheet.pins.push_back(pins);
  }
  builder.add_body(sheet);
  const double away = given.gap + given.thickness;
  if (given.plates) {
    for (const double z : {-away, away})
      builder.add_body(rigid_sheet(z < 0 ? "below" : "above", Vec3d(0, 0, z)));
  } else {
    add_plane(builder, "floor", -away, 1);
    if (!given.only_floor) add_plane(builder, "ceiling", away, -1);
  }
  if (given.far_body) builder.add_body(rigid_sheet("far", Vec3d(1e10, 0, 5)));
  Scene scene = builder.finish();
  std::mt19937 random(given.seed);
  for (Eigen::Index v = 0; v < scene.x0.cols(); ++v) {
    if (scene.body[static_cast<std::size_t>(v)] != 0) continue;
    const bool driven = std::abs(std::abs(scene.x0(0, v)) - 0.5) < 1e-6;
    const double part = std::uniform_real_distribution<double>(-1, 1)(random);
    if (!driven) scene.x0(2, v) += given.jitter * part;
  }
  return scene;
}

/// Every term exact first, and a contact stiffness that lets the sheet buckle.
inline Method saddle_method(SaddleRule rule, StepHessian hessian = StepHessian::blend, double kappa = 0.02) {
  Method method = fixed_method("log", kappa);
  method.hessian_mode = HessianMode::projected_full;
  for (const HessianChoice& choice : hessian_choices()) method.step_hessian[choice.name] = hessian;
  method.step_solver.tol_velocity = 1e-6;
  method.step_solver.max_iterations = 1000;
  method.step_solver.saddle = rule;
  return method;
}

}  // namespace bb::test
