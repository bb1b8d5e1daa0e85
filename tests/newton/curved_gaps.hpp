// A strip that falls on a disk: its edges roll over it, so their gaps are curved along the steps of Newton's method.
#pragma once

#include "tests/newton/small_scenes.hpp"

namespace bb::test {

inline constexpr double rolling_dt = 0.01;

/// In the plane, 1 m long and two elements high, 5 mm above the top of a disk, at 1 m/s. Two steps of 0.01 s bend it.
inline Scene strip_on_disk(double d_hat = 0.0025) {
  SceneBuilder builder("strip on disk", true, Vec3d(0, -9.81, 0), "test");
  BodySpec strip;
  strip.name = "strip";
  strip.mesh = grid_mesh(25, 3, 1, 1.0 / 12);
  const Vec3d middle = strip.mesh.vertices.rowwise().mean();
  strip.mesh.vertices.colwise() -= middle;
  strip.mesh.vertices.row(1).array() += 0.3 + 1.0 / 24 + 0.005;
  strip.material.density = 0.3;
  strip.material.youngs = 100;
  strip.d_hat = d_hat;
  strip.velocity = Vec3d(0, -1, 0);
  builder.add_body(strip);
  Obstacle disk;
  disk.name = "disk";
  disk.kind = ObstacleKind::sphere;
  disk.radius = 0.3;
  builder.add_obstacle(disk);
  return builder.finish();
}

/// The log barrier that carries `load` (N) at a tenth of d_hat.
inline Method soft_method(double load, double d_hat = 0.0025) {
  const BarrierFunction barrier{require_shape("log"), Argument::gap};
  Method method = fixed_method("log", -load / barrier.eval(d_hat / 10, d_hat).db);
  method.hessian_mode = HessianMode::projected_full;
  for (const char* term : {"membrane", "contact"}) method.step_hessian[term] = StepHessian::blend;
  method.step_solver.max_iterations = 500;
  method.step_solver.tol_velocity = 1e-7;
  return method;
}

}  // namespace bb::test
