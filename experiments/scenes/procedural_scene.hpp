// A scene that a name and a few parameters make. One file and one line in registry.inc each.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/parameters/parameter.hpp"
#include "core/base/parameters/registry.hpp"
#include "core/model/bodies/scene_builder.hpp"

namespace bb {

/// What a config leaves out is taken from its scene.
struct SceneDefaults {
  double dt = 0.01;  // s
  int steps = 100;
  double d_hat = 0.01;          // m
  std::optional<double> limit;  // 1; absent: strain_limit is off
};

/// What the rest of the config decides about a scene.
struct SceneContext {
  double d_hat = 0.01;                   // m
  std::optional<StrainLimitSpec> limit;  // absent: no limit
};

struct ProceduralScene {
  std::string name, doc;
  bool planar = false;
  SceneDefaults defaults;
  std::vector<Parameter> parameters;  // one of them is gravity_m_per_s2: downwards, -y when planar, else -z
  /// parameters: complete. Errors: ConfigError.
  Scene (*build)(const ParameterMap& parameters, const SceneContext& context) = nullptr;
};

/// All scenes, in the order of registry.inc.
const Registry<ProceduralScene>& procedural_scenes();

/// Downward gravity of a complete parameter map, m/s^2.
Vec3d gravity_of(const ProceduralScene& scene, const ParameterMap& parameters);

/// The parameter every scene has.
Parameter gravity_parameter();

/// The material of the parameters that are named like its keys (`bench list parts`), behind `prefix`: one of youngs_Pa and
/// youngs_N_per_m is among them.
Material material_from(const ParameterMap& parameters, const std::string& prefix = "");

/// Cloth parameters shared by the shell scenes, and the material they make with the strain limit of the config.
///   Defaults: cotton, E 0.8 MPa, nu 0.243, 472.6 kg/m^3, 0.318 mm (values used by Li, Kaufman, Jiang 2021,
///   measured by Penava et al. 2014).
std::vector<Parameter> cloth_parameters();
Material cloth_material(const ParameterMap& parameters, const SceneContext& context);

}  // namespace bb
