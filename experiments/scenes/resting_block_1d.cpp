// One equilateral triangle above a plane: three equal contacts under a third of the weight each, and nothing else. All
// vertices are at one height, so no element is strained: at rest kappa |b'(d)| is that third, in newtons.
#include <cmath>

#include "experiments/scenes/procedural_scene.hpp"

namespace bb {
namespace {

constexpr double edge = 0.1;  // m; any size does, the triangle only carries the mass

TriangleMesh equilateral_triangle(double height) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 3);
  mesh.vertices.col(0) = Vec3d(0, 0, height);
  mesh.vertices.col(1) = Vec3d(edge, 0, height);
  mesh.vertices.col(2) = Vec3d(0.5 * edge, 0.5 * std::sqrt(3.0) * edge, height);
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

Scene build_resting_block_1d(const ParameterMap& p, const SceneContext& context) {
  SceneBuilder builder("resting_block_1d", false, Vec3d(0, 0, -number(p, "gravity_m_per_s2")),
                       "scene resting_block_1d");
  BodySpec block;
  block.name = "block";
  block.mesh = equilateral_triangle(number(p, "start_gap_d_hat") * context.d_hat);
  block.material.youngs = number(p, "youngs_N_per_m");
  block.material.density = number(p, "mass_kg") / (std::sqrt(3.0) / 4 * edge * edge);
  block.material.limit = context.limit;
  block.d_hat = context.d_hat;
  builder.add_body(block);
  Obstacle plane;
  plane.name = "plane";
  builder.add_obstacle(plane);
  return builder.finish();
}

}  // namespace

ProceduralScene make_scene_resting_block_1d() {
  ProceduralScene scene;
  scene.defaults = {0.01, 200, 0.01, std::nullopt};
  scene.build = build_resting_block_1d;
  scene.parameters = {
      {"mass_kg", positive("kg"), 0.3, "mass of the block"},
      {"youngs_N_per_m", positive("N/m"), 100, "Young's modulus times thickness; never strained"},
      {"start_gap_d_hat", positive("d_hat"), 0.9, "gap at the start"},
      gravity_parameter(),
  };
  return scene;
}

}  // namespace bb
