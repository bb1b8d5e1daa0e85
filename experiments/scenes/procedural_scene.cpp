#include "experiments/scenes/procedural_scene.hpp"

#include "barriers/named_entries.hpp"

namespace bb {

#define ENTRY(name, doc) ProceduralScene make_scene_##name();
#include "experiments/scenes/registry.inc"
#undef ENTRY

namespace {

ProceduralScene named(ProceduralScene scene, const char* name, const char* doc) {
  scene.name = name;
  scene.doc = doc;
  return scene;
}

}  // namespace

const std::vector<ProceduralScene>& procedural_scenes() {
#define ENTRY(name, doc) named(make_scene_##name(), #name, doc),
  static const std::vector<ProceduralScene> list{
#include "experiments/scenes/registry.inc"
  };
#undef ENTRY
  return list;
}

const ProceduralScene* find_procedural_scene(std::string_view name) {
  return find_entry(procedural_scenes(), name);
}

Parameter gravity_parameter() { return non_negative("gravity_m_per_s2", "m/s^2", 9.81, "downward gravity"); }

Vec3d gravity_of(const ProceduralScene& scene, const ParameterMap& parameters) {
  Vec3d gravity = Vec3d::Zero();
  gravity[scene.planar ? 1 : 2] = -number(parameters, "gravity_m_per_s2");
  return gravity;
}

std::vector<Parameter> cloth_parameters() {
  return {
      positive("youngs_Pa", "Pa", 8e5, "Young's modulus of the cloth"),
      positive("thickness_m", "m", 3.18e-4, "thickness that multiplies Young's modulus; contact ignores it"),
      number_in("poisson", "1", 0.243, 0, 0.49, "Poisson's ratio, plane stress"),
      positive("density_kg_per_m2", "kg/m^2", 0.15, "mass per area"),
      non_negative("bending_J", "J", 1e-5, "stiffness of every hinge"),
  };
}

Material cloth_material(const ParameterMap& parameters, const SceneContext& context) {
  Material material;
  material.youngs = number(parameters, "youngs_Pa");
  material.thickness = number(parameters, "thickness_m");
  material.poisson = number(parameters, "poisson");
  material.density = number(parameters, "density_kg_per_m2");
  material.bending = number(parameters, "bending_J");
  material.limit = context.limit;
  return material;
}

}  // namespace bb
