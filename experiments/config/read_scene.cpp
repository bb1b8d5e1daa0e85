// The scene section: a registered scene with its parameters, or bodies and obstacles.
#include <fmt/format.h>

#include <set>

#include "barriers/named_entries.hpp"
#include "core/energy/membrane_model.hpp"
#include "core/input/read_file.hpp"
#include "core/record/provenance.hpp"
#include "experiments/config/mesh_generators.hpp"
#include "experiments/config/reader.hpp"

namespace bb {
namespace {

using nlohmann::json;

/// The members of an object as parameters, without the keys in `skip`.
ParameterMap to_parameters(const json& object, const std::set<std::string>& skip, const std::string& pointer,
                           const std::vector<Parameter>& table, const Reader& reader) {
  ParameterMap given;
  for (const auto& [key, value] : object.items()) {
    if (skip.contains(key)) continue;
    if (value.is_boolean()) {
      given[key] = value.get<bool>();
    } else if (value.is_number_integer()) {
      given[key] = value.get<std::int64_t>();
    } else if (value.is_number()) {
      given[key] = value.get<double>();
    } else if (value.is_string()) {
      given[key] = value.get<std::string>();
    } else if (const Parameter* parameter = find_entry(table, key)) {
      reader.complain(pointer + "/" + key, value.dump(), allowed_text(*parameter));
    } else {
      reader.take(unknown_name(reader.source + "#" + pointer + "/" + key, key, entry_names(table)));
    }
  }
  return given;
}

/// Unit vector; a zero vector is a violation.
Vec3d read_axis(const json& object, const char* key, const Vec3d& fallback, const std::string& pointer,
                const Reader& reader) {
  const Vec3d axis = vector_or(object, key, fallback);
  const double length = axis.norm();
  if (!(length > 0)) {
    reader.complain(pointer + "/" + key, "a zero vector", "a direction");
    return fallback;
  }
  // What was normalised once is left as it is, so that a resolved config reads back bit for bit.
  return std::abs(length - 1) < 1e-14 ? axis : Vec3d(axis / length);
}

RigidMotion read_motion(const json& object, const std::string& pointer, const Reader& reader) {
  RigidMotion motion;
  motion.velocity = vector_or(object, "velocity_m_per_s", motion.velocity);
  motion.center = vector_or(object, "center_m", motion.center);
  motion.axis = read_axis(object, "axis", motion.axis, pointer, reader);
  motion.angular_velocity = object.value("angular_velocity_rad_per_s", 0.0);
  motion.start = object.value("start_s", 0.0);
  motion.end = object.value("end_s", motion.end);
  if (!(motion.end >= motion.start)) {
    reader.complain(pointer + "/end_s", fmt::format("{}", motion.end),
                    fmt::format("a number >= {} (s)", motion.start));
  }
  return motion;
}

MeshSource read_mesh_source(const json& object, const std::string& pointer, const Reader& reader) {
  MeshSource mesh;
  const bool from_file = object.contains("file");
  if (from_file == object.contains("generator")) {
    if (reader.complete || from_file) {
      reader.complain(pointer, from_file ? "file and generator" : "nothing", "either file or generator");
    }
    return mesh;
  }
  if (!from_file) {
    mesh.generator = object["generator"].get<std::string>();
    const std::string where = pointer + "/generator";
    const MeshGenerator* generator = find_entry(mesh_generators(), mesh.generator);
    if (!generator) {
      reader.take(unknown_name(reader.source + "#" + where, mesh.generator, entry_names(mesh_generators())));
      return mesh;
    }
    const ParameterMap given = to_parameters(object, {"generator"}, pointer, generator->parameters, reader);
    mesh.parameters =
        complete_parameters(generator->parameters, given, reader.source + "#" + pointer, reader.violations);
    return mesh;
  }
  for (const auto& item : object.items()) {
    if (item.key() != "file" && item.key() != "sha256") {
      reader.complain(pointer + "/" + item.key(), "the key \"" + item.key() + "\" beside file",
                      "file and sha256 only");
    }
  }
  mesh.file = object["file"].get<std::string>();
  try {
    mesh.sha256 = sha256_hex(read_input_file(mesh.file, mesh_file));
  } catch (const ConfigError& error) {
    const Violation& wrong = error.violations().front();
    reader.complain(pointer + "/file", object["file"].dump() + ": " + wrong.found, wrong.allowed);
    return mesh;
  }
  if (object.contains("sha256") && object["sha256"] != mesh.sha256) {
    reader.complain(pointer + "/sha256", object["sha256"].dump(),
                    "\"" + mesh.sha256 + "\", the hash of " + mesh.file);
  }
  return mesh;
}

Material read_material(const json& object, const std::string& pointer, const Reader& reader) {
  Material m;
  m.model = object.value("model", m.model);
  if (object.contains("warp_axis") || is_anisotropic(m.model)) {
    m.warp_axis = read_axis(object, "warp_axis", Vec3d::UnitX(), pointer, reader);
  }
  const bool pascal = object.contains("youngs_Pa"), thick = object.contains("thickness_m");
  if (pascal && object.contains("youngs_N_per_m")) {
    reader.complain(pointer, "youngs_Pa and youngs_N_per_m", "one of the two");
  } else if (pascal != thick) {
    reader.complain(pointer, pascal ? "youngs_Pa without thickness_m" : "thickness_m without youngs_Pa",
                    "youngs_Pa with thickness_m, or youngs_N_per_m alone");
  }
  m.youngs = object.value(pascal ? "youngs_Pa" : "youngs_N_per_m", 100.0);
  m.thickness = optional_number(object, "thickness_m");
  m.poisson = object.value("poisson", m.poisson);
  m.density = object.value("density_kg_per_m2", m.density);
  m.line_density = object.value("line_density_kg_per_m", m.line_density);
  m.bending = object.value("bending_J", m.bending);
  m.springs = object.value("springs_N_per_m", m.springs);
  return m;
}

PinSpec read_pin(const json& object, const std::string& pointer, const Reader& reader) {
  PinSpec pin;
  pin.indices = object.value("indices", std::vector<int>());
  if (object.contains("box_m")) pin.box = {to_vector(object["box_m"][0]), to_vector(object["box_m"][1])};
  pin.top_row = object.value("top_row", false);
  pin.all = object.value("all", false);
  pin.motion = read_motion(child(object, "motion"), pointer + "/motion", reader);
  if (pin.indices.empty() && !pin.box && !pin.top_row && !pin.all) {
    reader.missing(pointer, "at least one of indices, box_m, top_row, all");
  }
  return pin;
}

void check_kind(const json& object, bool rigid, const std::string& pointer, const Reader& reader) {
  const std::vector<const char*> misplaced =
      rigid ? std::vector<const char*>{"material", "velocity_m_per_s", "pins", "limited"}
            : std::vector{"motion"};
  for (const char* key : misplaced) {
    if (!object.contains(key)) continue;
    reader.complain(
        pointer + "/" + key, fmt::format("{} of a {} body", key, rigid ? "rigid" : "deformable"),
        rigid ? "motion: every vertex of a rigid body is prescribed" : "pins with a motion, or kind rigid");
  }
}

BodyConfig read_body(const json& object, const std::string& pointer, const Reader& reader) {
  BodyConfig body;
  body.spec.name = object.value("name", "");
  const bool rigid = object.value("kind", "deformable") == "rigid";
  body.spec.kind = rigid ? BodyKind::rigid : BodyKind::deformable;
  check_kind(object, rigid, pointer, reader);
  body.mesh = read_mesh_source(child(object, "mesh"), pointer + "/mesh", reader);
  const json& transform = child(object, "transform");
  body.transform.scale = transform.value("scale", 1.0);
  body.transform.axis = read_axis(transform, "axis", body.transform.axis, pointer + "/transform", reader);
  body.transform.angle = transform.value("angle_deg", 0.0);
  body.transform.translation = vector_or(transform, "translate_m", body.transform.translation);
  body.spec.material = read_material(child(object, "material"), pointer + "/material", reader);
  body.spec.velocity = vector_or(object, "velocity_m_per_s", body.spec.velocity);
  body.spec.motion = read_motion(child(object, "motion"), pointer + "/motion", reader);
  for (std::size_t p = 0; object.contains("pins") && p < object["pins"].size(); ++p) {
    body.spec.pins.push_back(read_pin(object["pins"][p], fmt::format("{}/pins/{}", pointer, p), reader));
  }
  body.spec.d_hat = object.value("d_hat_m", 0.0);
  body.spec.offset = object.value("offset_m", 0.0);
  body.limited = object.value("limited", true);
  return body;
}

Obstacle read_obstacle(const json& object, const std::string& pointer, const Reader& reader) {
  Obstacle obstacle;
  obstacle.name = object.value("name", "");
  const std::string kind = object.value("kind", "plane");
  obstacle.kind = kind == "plane"    ? ObstacleKind::plane
                  : kind == "sphere" ? ObstacleKind::sphere
                                     : ObstacleKind::cylinder;
  obstacle.point = vector_or(object, "point_m", obstacle.point);
  obstacle.axis = read_axis(object, "axis", obstacle.axis, pointer, reader);
  obstacle.radius = object.value("radius_m", 0.0);
  obstacle.inside = object.value("inside", false);
  const bool plane = obstacle.kind == ObstacleKind::plane;
  if (plane && obstacle.inside) reader.complain(pointer + "/inside", "true", "false: a plane has no inside");
  if (plane && object.contains("radius_m"))
    reader.complain(pointer + "/radius_m", "a radius", "none: a plane has no radius");
  if (!plane && !object.contains("radius_m")) reader.missing(pointer + "/radius_m", "a number > 0 (m)");
  if (obstacle.kind == ObstacleKind::sphere && object.contains("axis")) {
    reader.complain(pointer + "/axis", "an axis", "none: a sphere has no axis");
  }
  return obstacle;
}

void check_names(const SceneConfig& scene, const Reader& reader) {
  std::set<std::string> names;
  const auto check = [&](const std::string& name, const std::string& pointer) {
    if (!name.empty() && !names.insert(name).second) {
      reader.complain(pointer, '"' + name + '"', "a name that no other body or obstacle has");
    }
  };
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    check(scene.bodies[i].spec.name, fmt::format("/scene/bodies/{}/name", i));
  }
  for (std::size_t i = 0; i < scene.obstacles.size(); ++i) {
    check(scene.obstacles[i].name, fmt::format("/scene/obstacles/{}/name", i));
  }
}

const std::vector<std::string> body_scene_keys = {"name",   "bodies", "obstacles", "gravity_m_per_s2",
                                                  "planar", "pairs"};

void read_bodies_scene(const json& object, const Reader& reader, SceneConfig& scene) {
  scene.name = "bodies";
  for (const auto& item : object.items()) {
    if (find(body_scene_keys.begin(), body_scene_keys.end(), item.key()) == body_scene_keys.end()) {
      reader.take(unknown_name(reader.source + "#/scene/" + item.key(), item.key(), body_scene_keys));
    }
  }
  scene.planar = object.value("planar", false);
  scene.gravity = scene.planar ? Vec3d(0, -9.81, 0) : Vec3d(0, 0, -9.81);
  if (object.contains("gravity_m_per_s2")) {
    const json& gravity = object["gravity_m_per_s2"];
    const bool good =
        gravity.is_array() && gravity.size() == 3 &&
        std::all_of(gravity.begin(), gravity.end(), [](const json& g) { return g.is_number(); });
    if (good) {
      scene.gravity = to_vector(gravity);
    } else {
      reader.complain("/scene/gravity_m_per_s2", gravity.dump(), "an array of 3 numbers (m/s^2)");
    }
  }
  if (object.contains("pairs")) {
    if (!scene.planar)
      reader.complain("/scene/pairs", object["pairs"].dump(), "none: the scene is not planar");
    scene.pairs = object["pairs"] == "vertex_vertex" ? PlanarPairs::vertex_vertex : PlanarPairs::point_edge;
  }
  const json none = json::array();
  const json& bodies = object.contains("bodies") ? object["bodies"] : none;
  const json& obstacles = object.contains("obstacles") ? object["obstacles"] : none;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    scene.bodies.push_back(read_body(bodies[i], fmt::format("/scene/bodies/{}", i), reader));
  }
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    scene.obstacles.push_back(read_obstacle(obstacles[i], fmt::format("/scene/obstacles/{}", i), reader));
  }
  if (scene.bodies.empty()) reader.missing("/scene/bodies", "at least one body");
  check_names(scene, reader);
}

}  // namespace

const ProceduralScene* read_scene(const json& object, const Reader& reader, SceneConfig& scene) {
  const std::string name = object.value("name", object.contains("bodies") ? "bodies" : "");
  if (name == "bodies") {
    read_bodies_scene(object, reader, scene);
    return nullptr;
  }
  const ProceduralScene* found = find_procedural_scene(name);
  if (!found) {
    std::vector<std::string> names = entry_names(procedural_scenes());
    names.emplace_back("bodies");
    if (name.empty()) {
      reader.missing("/scene/name", fmt::format("one of {}", fmt::join(names, ", ")));
    } else {
      reader.take(unknown_name(reader.source + "#/scene/name", name, names));
    }
    return nullptr;
  }
  scene.name = name;
  scene.planar = found->planar;
  const ParameterMap given = to_parameters(object, {"name"}, "/scene", found->parameters, reader);
  scene.parameters =
      complete_parameters(found->parameters, given, reader.source + "#/scene", reader.violations);
  scene.gravity = gravity_of(*found, scene.parameters);
  return found;
}

}  // namespace bb
