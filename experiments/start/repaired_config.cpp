#include "experiments/start/repaired_config.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/record/run_folder.hpp"
#include "core/base/record/writer.hpp"
#include "core/math/error.hpp"
#include "core/model/bodies/body_spec.hpp"
#include "core/model/bodies/pin_selection.hpp"
#include "core/model/mesh/write_mesh.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/run/plan.hpp"
#include "experiments/run/start_check.hpp"

namespace bb {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

/// Faces of more than three corners stay one face, which PLY files of ours do not keep.
std::string obj_text(const TriangleMesh& mesh) {
  std::string out;
  for (const auto& p : mesh.vertices.colwise())
    out += fmt::format("v {:.17g} {:.17g} {:.17g}\n", p[0], p[1], p[2]);
  auto fan = mesh.fans.begin();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& first = mesh.triangles[t];
    out += fmt::format("f {} {} {}", first[0] + 1, first[1] + 1, first[2] + 1);
    if (fan != mesh.fans.end() && static_cast<std::size_t>((*fan)[0]) == t) {
      for (int more = 1; more < (*fan)[1]; ++more) out += fmt::format(" {}", mesh.triangles[++t][2] + 1);
      ++fan;
    }
    out += '\n';
  }
  for (const auto& s : mesh.segments) out += fmt::format("l {} {}\n", s[0] + 1, s[1] + 1);
  return out;
}

/// Writes one mesh of the body with these vertices; returns its name.
json write_mesh_of(const TriangleMesh& mesh, const Positions& vertices, const fs::path& folder,
                   std::string name) {
  TriangleMesh out = mesh;
  out.vertices = vertices;
  const bool solid = !mesh.tetrahedra.empty();
  name += solid ? ".ply" : ".obj";
  write_atomically(folder / name, solid ? ply_bytes(out) : obj_text(out));
  return {{"file", name}};
}

/// The vertices of pins as indices: places select others after a repair.
void write_pins(const BodySpec& spec, const Positions& start, bool planar, json& body) {
  for (std::size_t p = 0; p < spec.pins.size(); ++p) {
    json& pin = body["pins"][p];
    for (const char* key : {"box_m", "top_row", "all", "objects", "threshold"}) pin.erase(key);
    if (!spec.pins[p].pull) pin.erase("mix");
    pin["indices"] = select_vertices(spec.pins[p], spec, start, planar);
  }
}

void write_weights(const BodySpec& spec, const fs::path& folder, const std::string& prefix, json& body) {
  for (std::size_t g = 0; g < spec.weights.size(); ++g) {
    std::string text;
    for (const double weight : spec.weights[g].weight) text += fmt::format("{:.17g}\n", weight);
    const std::string name = fmt::format("{}_weights_{}.txt", prefix, g);
    write_atomically(folder / name, text);
    body["weights"][g] = {{"name", spec.weights[g].name}, {"file", name}};
  }
}

void write_body(const RunConfig& config, std::size_t i, const Positions& start, const fs::path& folder,
                json& body) {
  const BodyConfig& given = config.scene.bodies[i];
  const auto films = films_of(given);
  const bool has_film =
      std::any_of(films.begin(), films.end(), [](const auto* film) { return film->given(); });
  const bool placed =
      given.transform.scale != 1 || given.transform.angle != 0 || !given.transform.translation.isZero(0);
  if (has_film && placed) {
    throw ConfigError(fmt::format("{}#/scene/bodies/{}", config.source, i),
                      "a film and a transform of a body to repair",
                      "a transform of no effect, with the film where it is to be");
  }
  const BodySpec spec = placed_body(config, i);
  const std::string prefix = fmt::format("body_{}", i);
  body["mesh"] = write_mesh_of(spec.mesh, start, folder, prefix + "_start");
  if (!given.rest_film.given() && spec.kind == BodyKind::deformable)
    body["rest_mesh"] = write_mesh_of(spec.mesh, spec.mesh.vertices, folder, prefix + "_rest");
  body.erase("transform");
  write_pins(spec, spec.start ? *spec.start : spec.mesh.vertices, config.scene.planar, body);
  write_weights(spec, folder, prefix, body);
}

/// The config as it was written: what it builds is the repaired scene.
void require_same(const fs::path& file, const Scene& scene, const Positions& x) {
  const RunConfig config = load_config(file.string());
  const Scene built = build_scene(config);
  const auto refuse = [&file](const std::string& found, const char* allowed) {
    throw ConfigError(file.string(), found, allowed);
  };
  if (built.x0.cols() != x.cols() || built.x0 != x) refuse("another start", "the repaired one, bit for bit");
  if (built.rest != scene.rest) refuse("another rest shape", "that of the config");
  if (built.mass != scene.mass) refuse("other masses", "those of the config");
  const bool pins =
      std::equal(built.pins.begin(), built.pins.end(), scene.pins.begin(), scene.pins.end(),
                 [](const Pin& a, const Pin& b) { return a.vertex == b.vertex && a.motion == b.motion; });
  if (!pins) refuse("other pins", "those of the config");
  if (const auto failure = start_failure(config, built, plan_of(config, built).contacts))
    refuse(failure->detail, "a start from which a run begins");
}

void require_new(const fs::path& folder) {
  if (std::error_code error; fs::exists(folder, error))
    throw ConfigError("--out", '"' + folder.string() + "\", which is there already", "a new folder");
}

/// "a/b/" and "a/b/." are a/b.
fs::path named(const fs::path& folder) {
  const fs::path plain = folder.lexically_normal();
  return plain.has_filename() ? plain : plain.parent_path();
}

}  // namespace

void require_repairable(const RunConfig& config, const fs::path& folder) {
  if (config.scene.name != "bodies") {
    throw ConfigError(config.source + "#/scene/name", '"' + config.scene.name + '"',
                      "a scene given as bodies, whose starts are files");
  }
  require_new(named(folder));
}

void write_repaired(const RunConfig& config, const Scene& scene, const Positions& x,
                    const std::string& numbers, const fs::path& out) {
  require_repairable(config, out);
  const fs::path folder = named(out);
  RunConfig plain = config;
  plain.seeds.jitter = 0;
  const Positions before = build_scene(plain).x0;
  json document = settings_document(plain);
  const fs::path part = fmt::format("{}.part.{}", folder.string(), ::getpid());
  require_new(part);
  try {
    make_folder(part);
    for (std::size_t i = 0; i < config.scene.bodies.size(); ++i) {
      const Body& body = scene.bodies[i];
      const auto columns = x.middleCols(body.first_vertex, body.n_vertices);
      if (columns == before.middleCols(body.first_vertex, body.n_vertices)) continue;
      write_body(plain, i, columns.colwise() - config.scene.translation, part,
                 document["scene"]["bodies"][i]);
    }
    write_atomically(part / "config.json", document.dump(2) + "\n");
    write_atomically(part / "repair.json", numbers);
    require_same(part / "config.json", scene, x);
    move_into_place(part, folder);
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(part, ignored);
    throw;
  }
}

}  // namespace bb
