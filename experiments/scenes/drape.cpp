// Cloth layers above a static sphere, close enough that all of them touch within a few steps.
#include <cmath>
#include <numbers>

#include "core/base/input/memory.hpp"
#include "core/model/mesh/generators.hpp"
#include "experiments/scenes/procedural_scene.hpp"

namespace bb {
namespace {

/// Turns about the z axis.
void turn(Positions& x, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    x.col(i) = Vec3d(c * x(0, i) - s * x(1, i), s * x(0, i) + c * x(1, i), x(2, i));
  }
}

/// Lowest layer at start_gap above the sphere, whose top is the origin.
void add_layers(SceneBuilder& builder, const ParameterMap& p, const SceneContext& context) {
  const int n = integer(p, "n"), layers = integer(p, "layers");
  require_memory("scene drape: n, layers",  // of all layers, before the first is made
                 surface_memory(1.0 * layers * n * n, 2.0 * layers * (n - 1) * (n - 1)));
  const double width = number(p, "width_m");
  for (int layer = 0; layer < layers; ++layer) {
    BodySpec cloth;
    cloth.name = "layer" + std::to_string(layer);
    cloth.mesh = grid_mesh(n, n, width, width);
    turn(cloth.mesh.vertices, layer * number(p, "twist_deg") * std::numbers::pi / 180);
    const double height = number(p, "start_gap_d_hat") + layer * number(p, "spacing_d_hat");
    cloth.mesh.vertices.row(2).array() += height * context.d_hat;
    cloth.material = cloth_material(p, context);
    cloth.d_hat = context.d_hat;
    builder.add_body(cloth);
  }
}

void add_sphere(SceneBuilder& builder, const ParameterMap& p, const SceneContext& context) {
  const double radius = number(p, "sphere_radius_m");
  if (text(p, "sphere") == "mesh") {
    BodySpec sphere;
    sphere.name = "sphere";
    sphere.kind = BodyKind::rigid;
    sphere.mesh = icosphere_mesh(integer(p, "sphere_level"), radius);
    sphere.mesh.vertices.row(2).array() -= radius;
    sphere.d_hat = context.d_hat;
    builder.add_body(sphere);
  } else {
    Obstacle sphere;
    sphere.name = "sphere";
    sphere.kind = ObstacleKind::sphere;
    sphere.point = Vec3d(0, 0, -radius);
    sphere.radius = radius;
    builder.add_obstacle(sphere);
  }
}

Scene build_drape(const ParameterMap& p, const SceneContext& context) {
  SceneBuilder builder("drape", false, Vec3d(0, 0, -number(p, "gravity_m_per_s2")), "scene drape");
  add_layers(builder, p, context);
  add_sphere(builder, p, context);
  return builder.finish();
}

}  // namespace

ProceduralScene make_scene_drape() {
  ProceduralScene scene;
  scene.defaults = {0.01, 100, 5e-3, 0.02};
  scene.build = build_drape;
  scene.parameters = {
      {"layers", count(1, 100), 5, "number of cloths"},
      {"n", count(2, 1000), 16, "vertices along a side of each cloth"},
      {"width_m", positive("m"), 1, "side of each cloth"},
      {"spacing_d_hat", open_low(number_in(0, 1e6, "d_hat")), 1.5,
       "distance between neighbouring layers at the start; below 1 they are in contact there"},
      {"start_gap_d_hat", positive("d_hat"), 1.2, "gap between the sphere and the lowest layer at the start"},
      {"twist_deg", number_in(-360, 360, "deg"), 9,
       "turn of each layer against the one below; 0 puts vertex over vertex, every contact on a "
       "feature boundary"},
      {"sphere", word({"analytic", "mesh"}), "analytic",
       "an analytic sphere, against which vertices, edges and faces are held, or a static icosphere"},
      {"sphere_radius_m", positive("m"), 0.25, "radius of the sphere"},
      {"sphere_level", count(0, 6), 3, "subdivisions of the icosphere (sphere = mesh)"},
      gravity_parameter(),
  };
  const std::vector<Parameter> cloth = cloth_parameters();
  scene.parameters.insert(scene.parameters.end(), cloth.begin(), cloth.end());
  return scene;
}

}  // namespace bb
