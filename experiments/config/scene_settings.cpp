// The lists of a scene: bodies with what belongs to them, obstacles (scene.inc); and which list rules a scene
// or a mesh.
#include <limits>
#include <type_traits>

#include "experiments/config/films.hpp"
#include "experiments/config/mesh_generators.hpp"
#include "experiments/config/sections.hpp"
#include "experiments/scenes/procedural_scene.hpp"

namespace bb {
namespace {

using nlohmann::json;

json mesh_json(const MeshSource& mesh) {
  if (!mesh.given()) return {};
  if (!mesh.file.empty()) {
    json out = {{"file", mesh.file}, {"sha256", mesh.sha256}};
    if (!mesh.objects.empty()) out["objects"] = mesh.objects;
    return out;
  }
  json made = to_json(mesh.parameters);
  made["generator"] = mesh.generator;
  return made;
}

/// Read by read_scene, which opens their files.
void add_meshes(Settings<BodyConfig>& out) {
  out.add_row({"mesh", required(mesh_rule()), no_default, ""}, nullptr,
              [](const BodyConfig& body) { return mesh_json(body.mesh); });
  out.add_row({"rest_mesh", mesh_rule(), no_default,
               "Mesh of the same elements whose vertices are the rest shape; `mesh` is where the body "
               "starts. Left out: `mesh` is both."},
              nullptr, [](const BodyConfig& body) { return mesh_json(body.rest_mesh); });
  out.add_row(
      {"rest_film", film_rule(), no_default,
       "The rest shape over time, of all elements of the body; mass is that of its place at the time 0. Left "
       "out: it stays."},
      nullptr, [](const BodyConfig& body) { return film_json(body.rest_film); });
}

void add_film(Settings<PrescribedMotion>& out) {
  out.add_row(
      {"film", film_rule(), no_default,
       "Positions of all vertices of the body over time, before the operations. Left out: where they start."},
      nullptr, [](const PrescribedMotion& motion) { return film_json(motion.film_source); });
}

/// Read by read_weights, which opens it.
void add_weights_file(Settings<WeightGroupConfig>& out) {
  const auto row = [&out](const char* name, Rule rule, const char* doc, std::string HashedFile::*member) {
    out.add_row({name, std::move(rule), no_default, doc}, nullptr, [member](const WeightGroupConfig& group) {
      return group.file.path.empty() ? json() : json(group.file.*member);
    });
  };
  row("file", text_up_to(0),
      "Path of a text file: one number from 0 to 1 in a line, in the order of the vertices.",
      &HashedFile::path);
  row("sha256", any_text(), "Expected SHA-256 of the file (hex).", &HashedFile::sha256);
}

/// Of a MotionStep, and of the first operation of a PrescribedMotion.
template <class S>
void add_motion_rows(Settings<S>& out) {
  const auto row = [&out](auto member, const char* name, Rule rule, const char* doc) {
    out.add(
        name, std::move(rule), doc, [member](auto& s) -> auto& { return s.*member; });
  };
  row(&MotionStep::velocity, "velocity_m_per_s", any_vector("m/s"), "Linear velocity.");
  row(&MotionStep::center, "center_m", any_vector("m"), "A point of the axis.");
  row(&MotionStep::axis, "axis", direction(), "Axis of the rotation.");
  row(&MotionStep::angular_velocity, "angular_velocity_rad_per_s", any_number("rad/s"),
      "About axis through center_m.");
  row(&MotionStep::start, "start_s", any_number("s"), "Start of the motion.");
  row(&MotionStep::end, "end_s", computed(any_number("s"), "never"), "End of the motion.");
  row(&MotionStep::scale, "scale", positive("1"),
      "Factor on distances from center_m that is reached at end_s.");
  row(&MotionStep::smooth, "smooth", flag(),
      "From start_s to end_s, or from keyframe to keyframe, as 3 f^2 - 2 f^3 instead of f, the part of the "
      "time.");
  out.nest_all(
      "keyframes", "Where the motion is at given times, linear between them; instead of rates and scale.",
      // resolved configs have an empty list in the operations of `then`
      std::is_same_v<S, PrescribedMotion> ? 1 : 0, 10000, settings_of<Keyframe>(),
      [](auto& s) -> auto& { return s.keyframes; });
}

Rule listed(Kind kind, Rule element) {
  element.kind = kind;
  return element;
}

}  // namespace

#define SECTION(type, doc)   \
  template <>                \
  Settings<type> list_of() { \
    using S = type;          \
    Settings<S> out(doc);
#define ACCESS(member) \
  [](auto& s) -> auto& { return s.member; }
#define ROW(member, name, rule, doc) out.add(name, rule, doc, ACCESS(member));
#define NEST(member, name, type) out.nest(name, settings_of<type>(), ACCESS(member));
#define ALL(member, name, doc, least, most, type) \
  out.nest_all(name, doc, least, most, settings_of<type>(), ACCESS(member));
#define EXTRA(add) add(out);
#define END_SECTION \
  return out;       \
  }
#include "experiments/config/scene.inc"

namespace {

std::vector<std::string> scene_names() {
  std::vector<std::string> names = procedural_scenes().names();
  names.emplace_back("bodies");
  return names;
}

Parameter name_row() {
  return {"name", required(name_in(scene_names)), no_default, "A registered scene, or \"bodies\"."};
}

Parameter translation_row() {
  return {"translate_m", any_vector("m"), no_default,
          "Moves all start positions, obstacles and motions of the scene; the rest shape stays. Left out: "
          "not at all."};
}

ParameterList scene_list(const json& scene) {
  const std::string name = scene.contains("name")
                               ? scene["name"].is_string() ? scene["name"].get<std::string>() : ""
                           : scene.contains("bodies") ? "bodies"
                                                      : "";
  if (const ProceduralScene* found = procedural_scenes().find(name)) {
    ParameterList list{found->doc, {name_row()}, false, {}, ""};
    list.rows.insert(list.rows.end(), found->parameters.begin(), found->parameters.end());
    list.rows.push_back(translation_row());
    return list;
  }
  ParameterList list = settings_of<SceneConfig>().rows();
  list.rows.push_back(translation_row());
  list.rows.front() = name_row();
  list.rows.front().rule.required = name != "bodies" && scene.is_object();  // null: the schema of any scene
  list.open = name != "bodies";
  if (list.open) {
    list.doc =
        "A registered scene: its name and its parameters (`bench list scenes`). Or a scene given as bodies: "
        "bodies, "
        "obstacles, gravity_m_per_s2, planar.";
  }
  return list;
}

ParameterList mesh_list(const json& mesh) {
  const Parameter generator{"generator", name_in([] { return mesh_generators().names(); }), no_default,
                            "A mesh generator (`bench list generators`)."};
  const Parameter file{"file", text_up_to(0), no_default, "Path of a mesh file."};
  const Parameter sha256{"sha256", any_text(), no_default, "Expected SHA-256 of the file (hex)."};
  const Parameter objects{
      "objects", texts(), no_default,
      "Names of objects (o) and groups (g) of an OBJ file: the body has their faces and lines "
      "alone, with the vertices of these, numbered in the order of the file. Left out: all of "
      "the file."};
  const std::string doc =
      "{\"generator\": NAME, parameters...} or {\"file\": PATH} (.obj, .ply, .stl, .msh, .vtk, .vtu, .vtp, "
      "relative to the config).";
  ParameterList list{
      doc, {generator, file, sha256, objects}, true, {{"generator"}, {"file"}}, "either file or generator"};
  if (mesh.contains("file") && !mesh.contains("generator")) list.rows.erase(list.rows.begin());
  list.open = !mesh.contains("file");
  const bool named = mesh.contains("generator") && mesh["generator"].is_string() && !mesh.contains("file");
  const MeshGenerator* made = named ? mesh_generators().find(mesh["generator"].get<std::string>()) : nullptr;
  if (made == nullptr) return list;
  list.rows = {generator};
  list.rows.insert(list.rows.end(), made->parameters.begin(), made->parameters.end());
  list.open = false;
  return list;
}

Rule ruled_by(ParameterList (*list)(const json&)) {
  Rule rule;
  rule.kind = Kind::object;
  rule.list = list;
  return rule;
}

}  // namespace

Rule scene_rule() { return ruled_by(scene_list); }
Rule mesh_rule() { return ruled_by(mesh_list); }

namespace {

/// A motion as it was written before there were operations and keyframes, where it has none.
void leave_out_defaults(json& motion) {
  if (motion["scale"] == 1) motion.erase("scale");
  if (motion["smooth"] == false) motion.erase("smooth");
  for (const char* list : {"keyframes", "then"}) {
    if (motion[list].empty()) motion.erase(list);
  }
}

void leave_out_empty(json& object, std::initializer_list<const char*> lists) {
  for (const char* list : lists) {
    if (object.contains(list) && object[list].empty()) object.erase(list);
  }
}

void leave_out_constant_influences(json& object, const char* mix) {
  if (!object.contains(mix)) return;
  for (json& share : object[mix]) leave_out_empty(share, {"influence_schedule"});
}

/// Weights, as a config states them that has some.
void leave_out_of_weights(json& body) {
  leave_out_empty(body, {"weights", "pressure_mix", "stiffness_weights"});
  leave_out_constant_influences(body, "pressure_mix");
  if (body.contains("stiffness_weights")) {
    for (json& weights : body["stiffness_weights"]) leave_out_constant_influences(weights, "mix");
  }
  if (!body.contains("weights")) return;
  for (json& group : body["weights"]) {
    leave_out_empty(group, {"boxes"});
    if (!group.contains("from_m")) group.erase("axis");
  }
}

void leave_out_defaults_of_body(json& body) {
  if (body.contains("motion")) leave_out_defaults(body["motion"]);
  if (body.contains("pressure_Pa") && body["pressure_Pa"] == 0) body.erase("pressure_Pa");
  if (body.contains("pressure_schedule")) {
    body.erase(body["pressure_schedule"].empty() ? "pressure_schedule" : "pressure_Pa");
  }
  if (body.contains("material")) {
    leave_out_empty(body["material"], {"shrink_schedule"});
    if (body["material"]["plasticity"] == 0) {
      for (const char* key : {"plasticity", "plasticity_step_s"}) body["material"].erase(key);
    }
  }
  leave_out_of_weights(body);
  if (!body.contains("pins")) return;
  for (json& pin : body["pins"]) {
    leave_out_defaults(pin["motion"]);
    leave_out_empty(pin, {"pull_factors", "mix"});
    leave_out_constant_influences(pin, "mix");
  }
}

/// What moves nothing is not written, so that a scene without it has the id that it had before there was such a key.
void leave_out_what_is_still(const SceneConfig& scene, json& out) {
  for (json& body : out["bodies"]) leave_out_defaults_of_body(body);
  for (std::size_t i = 0; i < scene.obstacles.size(); ++i) {
    json& obstacle = out["obstacles"][i];
    leave_out_defaults(obstacle["motion"]);
    if (scene.obstacles[i].motion.is_static()) obstacle.erase("motion");
  }
  out.erase(scene.gravity_keys.empty() ? "gravity_schedule" : "gravity_m_per_s2");
  if (scene.air.normal == 0 && scene.air.tangential == 0) out.erase("air");
  if (!scene.damping.acts()) out.erase("velocity_damping");
  if (scene.stitches.empty()) out.erase("stitches");
  for (std::size_t i = 0; i < scene.stitches.size(); ++i) {
    if (scene.stitches[i].rest_length == 0) out["stitches"][i].erase("rest_length_m");
  }
  if (scene.collisions.empty()) out.erase("collisions");
}

json untranslated_json(const SceneConfig& scene) {
  if (scene.name != "bodies") {
    json out = to_json(scene.parameters);
    out["name"] = scene.name;
    return out;
  }
  json out = settings_of<SceneConfig>().write(scene);
  if (!scene.planar) out.erase("pairs");
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    for (const std::string& key : keys_of_others(scene.bodies[i].spec.kind)) out["bodies"][i].erase(key);
  }
  for (std::size_t i = 0; i < scene.obstacles.size(); ++i) {
    for (const std::string& key : keys_of_others(scene.obstacles[i].kind)) out["obstacles"][i].erase(key);
  }
  leave_out_what_is_still(scene, out);
  return out;
}

}  // namespace

json scene_json(const SceneConfig& scene) {
  json out = untranslated_json(scene);
  const Vec3d& by = scene.translation;
  if (!by.isZero(0)) out["translate_m"] = {by[0], by[1], by[2]};
  return out;
}

std::vector<std::string> keys_of_others(BodyKind kind) {
  if (kind == BodyKind::rigid)
    return {"rest_mesh", "rest_film",    "material",         "velocity_m_per_s",
            "pins",      "limited",      "pressure_Pa",      "pressure_schedule",
            "weights",   "pressure_mix", "stiffness_weights"};
  return {"motion"};
}
std::vector<std::string> keys_of_others(ObstacleKind kind) {
  if (kind == ObstacleKind::plane) return {"radius_m", "inside"};
  if (kind == ObstacleKind::sphere) return {"axis"};
  return {};
}

}  // namespace bb
