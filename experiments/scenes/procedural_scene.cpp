#include "experiments/scenes/procedural_scene.hpp"

#include "core/model/bodies/material_settings.hpp"

namespace bb {

#define ENTRY(name, doc) ProceduralScene make_scene_##name();
#include "experiments/scenes/registry.inc"
#undef ENTRY

const Registry<ProceduralScene>& procedural_scenes() {
#define ENTRY(name, doc) named(make_scene_##name(), #name, doc),
  static const Registry<ProceduralScene> all({
#include "experiments/scenes/registry.inc"
  });
#undef ENTRY
  return all;
}

Parameter gravity_parameter() {
  return {"gravity_m_per_s2", non_negative("m/s^2"), 9.81, "downward gravity"};
}

Vec3d gravity_of(const ProceduralScene& scene, const ParameterMap& parameters) {
  Vec3d gravity = Vec3d::Zero();
  gravity[scene.planar ? 1 : 2] = -number(parameters, "gravity_m_per_s2");
  return gravity;
}

std::vector<Parameter> cloth_parameters() {
  return {
      {"youngs_Pa", positive("Pa"), 8e5, "Young's modulus of the cloth"},
      {"thickness_m", positive("m"), 3.18e-4,
       "thickness that multiplies Young's modulus; contact ignores it"},
      {"poisson", number_in(0, 0.49, "1"), 0.243, "Poisson's ratio, plane stress"},
      {"density_kg_per_m2", positive("kg/m^2"), 0.15, "mass per area"},
      {"bending_J", non_negative("J"), 1e-5, "stiffness of every hinge"},
  };
}

Material material_from(const ParameterMap& parameters, const std::string& prefix) {
  ParameterMap keys;
  for (const auto& [name, value] : parameters) {
    if (name.starts_with(prefix)) keys[name.substr(prefix.size())] = value;
  }
  Material material;
  settings_of<Material>().read(to_json(keys), material);
  return material;
}

Material cloth_material(const ParameterMap& parameters, const SceneContext& context) {
  Material material = material_from(parameters);
  material.limit = context.limit;
  return material;
}

}  // namespace bb
