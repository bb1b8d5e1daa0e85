// A hollow elastic sphere falling onto a sheet that is held along its rim: two deformable bodies
// of unlike stiffness.
#include <cmath>

#include "core/model/mesh/generators.hpp"
#include "core/model/mesh/topology.hpp"
#include "experiments/scenes/procedural_scene.hpp"

namespace bb {
namespace {

BodySpec make_sheet(const ParameterMap& p, const SceneContext& context) {
  BodySpec sheet;
  sheet.name = "sheet";
  sheet.mesh = grid_mesh(integer(p, "n"), integer(p, "n"), number(p, "width_m"), number(p, "width_m"));
  sheet.material = cloth_material(p, context);
  sheet.d_hat = context.d_hat;
  PinSpec& rim = sheet.pins.emplace_back();
  for (const auto& edge : boundary_edges(sheet.mesh.triangles)) rim.indices.push_back(edge[0]);
  return sheet;
}

/// No strain limit: what is limited is the cloth that it lands on.
BodySpec make_sphere(const ParameterMap& p, const SceneContext& context) {
  BodySpec sphere;
  sphere.name = "sphere";
  const double radius = number(p, "sphere_radius_m");
  sphere.mesh = icosphere_mesh(integer(p, "sphere_level"), radius);
  sphere.mesh.vertices.row(2).array() += radius + number(p, "start_gap_d_hat") * context.d_hat;
  sphere.material = material_from(p, "sphere_");
  sphere.velocity = Vec3d(0, 0, -number(p, "start_speed_m_per_s"));
  sphere.d_hat = context.d_hat;
  return sphere;
}

Scene build_sphere_on_sheet(const ParameterMap& p, const SceneContext& context) {
  SceneBuilder builder("sphere_on_sheet", false, Vec3d(0, 0, -number(p, "gravity_m_per_s2")),
                       "scene sphere_on_sheet");
  builder.add_body(make_sheet(p, context));
  builder.add_body(make_sphere(p, context));
  return builder.finish();
}

}  // namespace

ProceduralScene make_scene_sphere_on_sheet() {
  ProceduralScene scene;
  scene.defaults = {0.01, 50, 5e-3, 0.05};
  scene.build = build_sphere_on_sheet;
  scene.parameters = {
      {"n", count(3, 1000), 17, "vertices along a side of the sheet"},
      {"width_m", positive("m"), 1, "side of the sheet"},
      {"sphere_radius_m", positive("m"), 0.15, "radius of the sphere"},
      {"sphere_level", count(0, 6), 2, "subdivisions of the icosphere"},
      {"sphere_youngs_N_per_m", positive("N/m"), 2000,
       "Young's modulus times thickness of the sphere's shell"},
      {"sphere_density_kg_per_m2", positive("kg/m^2"), 1, "mass per area of the sphere's shell"},
      {"sphere_bending_J", non_negative("J"), 1e-3, "hinge stiffness of the sphere's shell"},
      {"start_gap_d_hat", positive("d_hat"), 1.2, "gap between sheet and sphere at the start"},
      {"start_speed_m_per_s", any_number("m/s"), 1, "speed of the sphere at the start, downwards"},
      gravity_parameter(),
  };
  const std::vector<Parameter> cloth = cloth_parameters();
  scene.parameters.insert(scene.parameters.end(), cloth.begin(), cloth.end());
  return scene;
}

}  // namespace bb
