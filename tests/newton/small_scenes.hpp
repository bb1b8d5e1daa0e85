// Scenes made by hand for the Newton tests: small enough that the answer is known.
#pragma once

#include <string>

#include "barriers/shapes/registry.hpp"
#include "barriers/stiffness/registry.hpp"
#include "core/model/bodies/scene_builder.hpp"
#include "core/model/integrators/registry.hpp"
#include "core/model/mesh/generators.hpp"
#include "core/newton/method.hpp"
#include "core/step_solvers/simulation.hpp"
#include "core/terms/contact.hpp"
#include "tests/barriers/limit_policies.hpp"

namespace bb::test {

inline Method fixed_method(const std::string& shape, double kappa,
                           const std::string& integrator = "implicit_euler") {
  Method method;
  method.contact = {require_shape(shape), Argument::gap};
  PolicyConfig policy;
  policy.parameters["kappa_N_per_m"] = kappa;
  method.stiffness = make_policy(policy);
  method.limit = {require_shape(shape), Argument::gap};
  method.limit_stiffness = fixed_limit(0);  // a limit bounds steps and has no force, unless a test reports
  method.integrator = make_integrator(integrator);
  method.step_solver.tol_velocity = 1e-6;
  return method;
}

inline Positions one_point(double x, double y, double z) {
  Positions point(3, 1);
  point << x, y, z;
  return point;
}

/// The rows of the iterate.
inline const ContactState& rows_of(NewtonSystem& system) { return contact_state(system.diagnosis().terms()); }

/// Tries x [3 x n] m, at the end of a straight motion from the iterate.
inline std::optional<EnergyChange> try_state(NewtonSystem& system, const Positions& x) {
  system.set_direction(x - system.view().x());
  system.prepare_motion(MotionEnd::free, false);
  return system.try_motion(1);
}

/// The same by feasibility alone.
inline bool is_feasible(NewtonSystem& system, const Positions& x) {
  system.set_direction(x - system.view().x());
  system.prepare_motion(MotionEnd::free, false);
  return system.try_feasible(1);
}

/// Newton direction towards a target, both [3 x n] m.
inline SolveReport solve(NewtonSystem& system, const Positions& target, Positions& dx) {
  system.set_target(target);
  const SolveReport report = system.find_direction();
  dx = system.diagnosis().direction();
  return report;
}

/// What the terms report of the iterate.
inline IterateNumbers reported(NewtonSystem& system) {
  IterateNumbers out;
  system.view().report(out);
  return out;
}

/// One free particle of mass m (kg) at height z (m) over the plane z = 0.
inline Scene particle_over_plane(double mass, double height, double d_hat) {
  Scene scene;
  scene.name = "particle";
  scene.bodies = {{"particle", 0, 1}};
  scene.rest = scene.x0 = one_point(0, 0, height);
  scene.v0 = Positions::Zero(3, 1);
  scene.mass = {mass};
  scene.body = {0};
  scene.d_hat = {d_hat};
  scene.offset = {0};
  scene.gravity = Vec3d(0, 0, -10);
  scene.surface_vertices = {0};
  Obstacle plane;
  plane.name = "floor";
  scene.obstacles = {plane};
  return scene;
}

/// A square cloth of n x n vertices and side 1 m, flat at height z; bending and a strain limit on request.
inline BodySpec cloth_spec(int n, double height, double d_hat) {
  BodySpec spec;
  spec.name = "cloth";
  spec.mesh = grid_mesh(n, n, 1.0, 1.0);
  spec.mesh.vertices.row(2).array() += height;
  spec.material.density = 0.3;
  spec.material.youngs = 100;
  spec.d_hat = d_hat;
  return spec;
}

/// A cloth that is thrown against a floor and meets it within the first steps of 10 ms.
inline Scene thrown_cloth(double d_hat) {
  SceneBuilder builder("thrown cloth", false, Vec3d(0, 0, -10), "test");
  BodySpec spec = cloth_spec(4, 0.012, d_hat);
  spec.material.bending = 1e-4;
  spec.velocity = Vec3d(0.4, 0.8, -1);
  builder.add_body(spec);
  Obstacle plane;
  plane.name = "floor";
  builder.add_obstacle(plane);
  return builder.finish();
}

}  // namespace bb::test
