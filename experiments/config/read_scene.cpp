// The scene section: a registered scene with its parameters, or bodies and obstacles; and what the list of
// settings alone cannot judge of them.
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <set>

#include "core/model/bodies/part.hpp"
#include "experiments/config/films.hpp"
#include "experiments/config/hashed_file.hpp"
#include "experiments/config/mesh_generators.hpp"
#include "experiments/config/reader.hpp"
#include "experiments/config/sections.hpp"
#include "experiments/config/weights.hpp"

namespace bb {
namespace {

using nlohmann::json;

/// The element of an array of objects, as the config gives it.
const json& given(const json& scene, const char* key, std::size_t i) { return scene.at(key).at(i); }

void read_mesh_file(const json& object, const std::string& pointer, const Reader& reader, MeshSource& mesh) {
  if (object.contains("objects")) mesh.objects = object["objects"].get<std::vector<std::string>>();
  HashedFile file;
  read_hashed(object, mesh_file, pointer, reader, file);
  mesh.file = file.path, mesh.sha256 = file.sha256;
}

void read_mesh(const json& object, const std::string& pointer, const Reader& reader, MeshSource& mesh) {
  if (object.contains("file") == object.contains("generator")) return;  // complained of by the check
  if (object.contains("file")) return read_mesh_file(object, pointer, reader, mesh);
  mesh.generator = object["generator"].get<std::string>();
  mesh.parameters = to_map(mesh_generators().require(mesh.generator, pointer).parameters, object);
}

/// A schedule without a key says nothing. Resolved configs give every key, so an empty list may stand beside the constant that
/// acts in its place; the other lists of keys are left out there, and their rules want one key.
void check_empty_schedules(const json& value, const std::string& pointer, const Reader& reader) {
  static const std::map<std::string, std::string> constants = {{"wind_schedule", "wind_m_per_s"},
                                                               {"keyframes", "scale"}};
  for (const auto& item : value.items()) {
    const std::string at = pointer + "/" + item.key();
    const auto constant = constants.find(item.key());
    if (constant != constants.end() && item.value() == json::array() && !value.contains(constant->second))
      reader.complain(at, "[]", "an array of at least 1 and at most 10000 elements");
    if (item.value().is_structured()) check_empty_schedules(item.value(), at, reader);
  }
}

/// Times of keys.
template <class K>
void check_times(const std::vector<K>& keys, const std::string& pointer, const Reader& reader) {
  for (std::size_t k = 1; k < keys.size(); ++k) {
    if (keys[k].time > keys[k - 1].time) continue;
    reader.complain(fmt::format("{}/{}/time_s", pointer, k), fmt::format("{}", keys[k].time),
                    fmt::format("a number > {}, the time before (s)", keys[k - 1].time));
  }
}

void check_step(const MotionStep& motion, const std::string& pointer, const Reader& reader) {
  check_times(motion.keyframes, pointer + "/keyframes", reader);
  const bool rates = !motion.velocity.isZero(0) || motion.angular_velocity != 0 || motion.scale != 1;
  if (!motion.keyframes.empty()) {
    if (rates) reader.complain(pointer, "rates or a scale beside keyframes", "one of both");
    return;
  }
  if (!(motion.end >= motion.start)) {
    reader.complain(pointer + "/end_s", fmt::format("{}", motion.end),
                    fmt::format("a number >= {} (s)", motion.start));
  }
  const bool to_an_end = motion.smooth || motion.scale != 1;
  if (to_an_end && !(motion.end > motion.start && std::isfinite(motion.end))) {
    reader.complain(pointer + "/end_s", std::isfinite(motion.end) ? fmt::format("{}", motion.end) : "nothing",
                    fmt::format("a number > {} (s): scale and smooth need one", motion.start));
  }
}

void check_motion(const PrescribedMotion& motion, const std::string& pointer, const Reader& reader) {
  check_step(motion, pointer, reader);
  for (std::size_t i = 0; i < motion.then.size(); ++i) {
    check_step(motion.then[i], fmt::format("{}/then/{}", pointer, i), reader);
  }
}

void read_motion(const json& object, const std::string& pointer, const Reader& reader,
                 PrescribedMotion& motion) {
  check_motion(motion, pointer, reader);
  read_film(child(object, "film"), pointer + "/film", reader, motion.film_source);
}

void settle_material(const json& object, const std::string& pointer, const Reader& reader, Material& m) {
  const Complaints complain{reader.source + "#" + pointer, reader.violations};
  for (const PartEntry& entry : part_entries()) entry.part.settle({object, reader.complete}, complain, m);
}

/// Settings that only bodies or obstacles of another kind have.
void check_kind(const json& object, const std::vector<std::string>& of_others, const std::string& kind,
                const std::string& pointer, const char* allowed, const Reader& reader) {
  for (const std::string& key : of_others) {
    if (!reader.complete || !object.contains(key) || object[key] == false) continue;
    reader.complain(fmt::format("{}/{}", pointer, key), fmt::format("{} of a {}", key, kind), allowed);
  }
}

/// A box whose corners are the wrong way round holds nothing.
void check_box(const PinSpec& pin, const std::string& pointer, const Reader& reader) {
  for (int k = 0; pin.box && k < 3; ++k) {
    const double low = (*pin.box)[0][k], high = (*pin.box)[1][k];
    if (low <= high) continue;
    reader.complain(
        pointer, fmt::format("an inverted box: along {} its min {} is above its max {}", "xyz"[k], low, high),
        "[[min], [max]] with min <= max along every axis");
  }
}

void check_span(const PinSpec& pin, const std::string& where, const Reader& reader) {
  const auto [hold, release] = pin.span;
  if (!(release > hold)) {
    reader.complain(where + "/release_s", fmt::format("{}", release),
                    fmt::format("a number > {}, when it begins to hold (s)", hold));
  }
}

void check_pull(const PinSpec& pin, const std::string& where, const Reader& reader) {
  if (pin.pull || !reader.complete) return;  // a wrong pull was one
  if (!pin.pull_factors.empty()) {
    reader.complain(where + "/pull_factors", "factors of no pull", "pull_N_per_m beside them");
  }
}

void settle_body(const json& object, const std::string& pointer, const Reader& reader, BodyConfig& body) {
  BodySpec& spec = body.spec;
  check_kind(object, keys_of_others(spec.kind), word_of(spec.kind) + " body", pointer,
             spec.kind == BodyKind::rigid ? "motion: every vertex of a rigid body is prescribed"
                                          : "pins with a motion, or kind rigid",
             reader);
  read_mesh(child(object, "mesh"), pointer + "/mesh", reader, body.mesh);
  read_mesh(child(object, "rest_mesh"), pointer + "/rest_mesh", reader, body.rest_mesh);
  read_film(child(object, "rest_film"), pointer + "/rest_film", reader, body.rest_film);
  if (body.rest_film.given() && body.rest_mesh.given()) {
    reader.complain(pointer + "/rest_film", "a rest film beside rest_mesh", "one of both");
  }
  settle_material(child(object, "material"), pointer + "/material", reader, spec.material);
  read_motion(child(object, "motion"), pointer + "/motion", reader, spec.motion);
  read_weights(object, pointer, reader, body.weights);
  check_times(spec.pressure_keys, pointer + "/pressure_schedule", reader);
  if (spec.pressure != 0 && !spec.pressure_keys.empty()) {
    reader.complain(pointer + "/pressure_Pa", "a pressure beside pressure_schedule", "one of both");
  }
  check_times(spec.material.shrink_keys, pointer + "/material/shrink_schedule", reader);
  for (std::size_t p = 0; p < spec.pins.size(); ++p) {
    PinSpec& pin = spec.pins[p];
    const std::string where = fmt::format("{}/pins/{}", pointer, p);
    read_motion(child(given(object, "pins", p), "motion"), where + "/motion", reader, pin.motion);
    check_box(pin, where + "/box_m", reader);
    check_times(pin.pull_factors, where + "/pull_factors", reader);
    check_span(pin, where, reader);
    check_pull(pin, where, reader);
    if (pin.indices.empty() && pin.objects.empty() && !pin.box && !pin.top_row && !pin.all &&
        pin.mix.empty()) {
      reader.missing(where, "at least one of indices, objects, box_m, top_row, all, mix");
    }
  }
}

void check_obstacle(const json& object, const std::string& pointer, const Reader& reader,
                    const Obstacle& obstacle) {
  check_kind(object, keys_of_others(obstacle.kind), word_of(obstacle.kind), pointer,
             "another kind of obstacle, or nothing", reader);
  if (obstacle.kind != ObstacleKind::plane && !object.contains("radius_m")) {
    reader.missing(pointer + "/radius_m", "a number > 0 (m)");
  }
  check_motion(obstacle.motion, pointer + "/motion", reader);
  if (child(object, "motion").contains("film")) {
    reader.complain(pointer + "/motion/film", "a film of an obstacle", "one of a rigid body, or of pins");
  }
}

void check_names(const SceneConfig& scene, const Reader& reader) {
  std::set<std::string> names;
  const auto check = [&](const std::string& name, const char* list, std::size_t i) {
    if (name.empty() || names.insert(name).second) return;
    reader.complain(fmt::format("/scene/{}/{}/name", list, i), '"' + name + '"',
                    "a name that no other body or obstacle has");
  };
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) check(scene.bodies[i].spec.name, "bodies", i);
  for (std::size_t i = 0; i < scene.obstacles.size(); ++i) check(scene.obstacles[i].name, "obstacles", i);
}

void read_schedules(const json& object, const Reader& reader, SceneConfig& scene) {
  check_times(scene.gravity_keys, "/scene/gravity_schedule", reader);
  check_times(scene.air.wind_keys, "/scene/air/wind_schedule", reader);
  if (!scene.air.wind.isZero(0) && !scene.air.wind_keys.empty()) {
    reader.complain("/scene/air/wind_m_per_s", "a wind beside wind_schedule", "one of both");
  }
  if (scene.gravity_keys.empty()) return;
  if (object.contains("gravity_m_per_s2")) {
    reader.complain("/scene/gravity_m_per_s2", object["gravity_m_per_s2"].dump(),
                    "nothing beside gravity_schedule");
  }
  scene.gravity = scene.gravity_keys.front().value;
}

void read_bodies(const json& object, const Reader& reader, SceneConfig& scene) {
  scene.planar = object.value("planar", false);
  scene.gravity = scene.planar ? Vec3d(0, -9.81, 0) : Vec3d(0, 0, -9.81);
  settings_of<SceneConfig>().read(object, scene);
  scene.name = "bodies";
  check_empty_schedules(object, "/scene", reader);
  read_schedules(object, reader, scene);
  if (object.contains("pairs") && !scene.planar) {
    reader.complain("/scene/pairs", object["pairs"].dump(), "nothing: the scene is not planar");
  }
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    settle_body(given(object, "bodies", i), fmt::format("/scene/bodies/{}", i), reader, scene.bodies[i]);
  }
  for (std::size_t i = 0; i < scene.obstacles.size(); ++i) {
    check_obstacle(given(object, "obstacles", i), fmt::format("/scene/obstacles/{}", i), reader,
                   scene.obstacles[i]);
  }
  if (scene.bodies.empty()) reader.missing("/scene/bodies", "at least one body");
  check_names(scene, reader);
}

void read_translation(const json& object, const Reader& reader, SceneConfig& scene) {
  const auto given = object.find("translate_m");
  if (given == object.end() || !given->is_array() || given->size() != 3)
    return;  // complained of by the check
  for (int k = 0; k < 3; ++k) scene.translation[k] = given->at(static_cast<std::size_t>(k)).get<double>();
  if (scene.planar && scene.translation[2] != 0) {
    reader.complain("/scene/translate_m", given->dump(), "a vector without z: the scene is planar");
  }
}

}  // namespace

const ProceduralScene* read_scene(const json& object, const Reader& reader, SceneConfig& scene) {
  const std::string name = object.value("name", object.contains("bodies") ? "bodies" : "");
  const ProceduralScene* found = procedural_scenes().find(name);
  if (name == "bodies") read_bodies(object, reader, scene);
  if (found != nullptr) scene.planar = found->planar;
  read_translation(object, reader, scene);
  if (found == nullptr) return nullptr;
  scene.name = name;
  scene.parameters = to_map(found->parameters, object);
  scene.gravity = gravity_of(*found, scene.parameters);
  return found;
}

}  // namespace bb
