// A horizontal cloth let go while two corners of one side are held.
#include "core/model/mesh/generators.hpp"
#include "experiments/scenes/procedural_scene.hpp"

namespace bb {
namespace {

Scene build_hang(const ParameterMap& p, const SceneContext& context) {
  const int n = integer(p, "n");
  const double width = number(p, "width_m");
  SceneBuilder builder("hang", false, Vec3d(0, 0, -number(p, "gravity_m_per_s2")), "scene hang");
  BodySpec cloth;
  cloth.name = "cloth";
  cloth.mesh = grid_mesh(n, n, width, width);
  cloth.material = cloth_material(p, context);
  cloth.d_hat = context.d_hat;
  cloth.pins.emplace_back().indices = {n * (n - 1), n * n - 1};
  builder.add_body(cloth);
  return builder.finish();
}

}  // namespace

ProceduralScene make_scene_hang() {
  ProceduralScene scene;
  scene.defaults = {0.01, 100, 5e-3, 0.05};
  scene.build = build_hang;
  scene.parameters = {
      {"n", count(2, 1000), 16, "vertices along a side"},
      {"width_m", positive("m"), 1, "side of the cloth"},
      gravity_parameter(),
  };
  const std::vector<Parameter> cloth = cloth_parameters();
  scene.parameters.insert(scene.parameters.end(), cloth.begin(), cloth.end());
  return scene;
}

}  // namespace bb
