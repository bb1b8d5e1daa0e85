// From a config to the numbers of its scene.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>
#include <random>
#include <utility>

#include "core/base/input/names.hpp"
#include "core/base/parameters/registry.hpp"
#include "core/model/bodies/scene_builder.hpp"
#include "core/model/mesh/bounds.hpp"
#include "core/model/mesh/read_mesh.hpp"
#include "core/model/mesh/same_cells.hpp"
#include "experiments/config/films.hpp"
#include "experiments/config/hashed_file.hpp"
#include "experiments/config/mesh_generators.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/config/step_promise.hpp"
#include "experiments/config/weights.hpp"
#include "experiments/scenes/procedural_scene.hpp"

namespace bb {
namespace {

/// The mesh of a body; a file has to be the one whose hash the config has.
MeshFile make_mesh(const MeshSource& source, const std::string& where) {
  if (source.file.empty()) {
    try {
      return {mesh_generators().require(source.generator, "mesh/generator").make(source.parameters), {}, {}};
    } catch (const ConfigError& error) {
      std::vector<Violation> violations = error.violations();
      for (Violation& v : violations) v.where = where + ": " + v.where;
      throw ConfigError(std::move(violations));
    }
  }
  const std::string bytes = unchanged({source.file, source.sha256}, mesh_file);
  return parse_mesh_file(bytes, source.file, {false, source.objects, where + "/objects"});
}

/// The vertices of the objects that pins name, those of them that the body has.
void take_pinned_objects(const MeshObjects& objects, const MeshSource& mesh, const std::string& where,
                         std::vector<PinSpec>& pins) {
  for (std::size_t p = 0; p < pins.size(); ++p) {
    for (std::size_t i = 0; i < pins[p].objects.size(); ++i) {
      const std::string place = fmt::format("{}/pins/{}/objects/{}", where, p, i);
      const MeshObject& object = objects.require(pins[p].objects[i], mesh.file, place);
      const std::vector<int> vertices = objects.mesh_vertices(object);
      if (vertices.empty()) {
        throw ConfigError(
            place,
            fmt::format("\"{}\", an object of {} of which the body has no vertex", shortened(object.name),
                        mesh.file),
            "an object that has vertices in common with those of mesh/objects: " + listed(mesh.objects));
      }
      pins[p].indices.insert(pins[p].indices.end(), vertices.begin(), vertices.end());
    }
  }
}

void apply(const TransformConfig& transform, Positions& x) {
  x *= transform.scale;
  if (transform.angle != 0) {
    const Eigen::AngleAxisd turn(transform.angle * std::numbers::pi / 180, transform.axis);
    x = turn.toRotationMatrix() * x;
  }
  x.colwise() += transform.translation;
}

/// The rest shape takes the vertices of another mesh of the same elements; where the body was is where it starts.
void take_rest_shape(const BodyConfig& body, const std::string& where, BodySpec& spec) {
  TriangleMesh rest = make_mesh(body.rest_mesh, where).mesh;
  if (rest.n_vertices() != spec.mesh.n_vertices()) {
    throw ConfigError(where, fmt::format("{} vertices", rest.n_vertices()),
                      fmt::format("{}, as the mesh of the body has", spec.mesh.n_vertices()));
  }
  require_same_cells(where, "triangles", rest.triangles, spec.mesh.triangles);
  require_same_cells(where, "faces of more than three corners", rest.fans, spec.mesh.fans);
  require_same_cells(where, "lone edges", rest.segments, spec.mesh.segments);
  require_same_cells(where, "tetrahedra", rest.tetrahedra, spec.mesh.tetrahedra);
  apply(body.transform, rest.vertices);
  spec.start = std::exchange(spec.mesh.vertices, std::move(rest.vertices));
}

/// The films of the motions and of the rest shape of a body, whose mesh is not placed yet.
void take_films(const BodyConfig& body, const std::string& where, BodySpec& spec) {
  const auto place = [&body](Positions& x) { apply(body.transform, x); };
  const auto film = [&](const FilmSource& source, const std::string& at) {
    return make_film(source, spec.mesh, place, where + at);
  };
  spec.motion.film = film(spec.motion.film_source, "/motion/film");
  for (std::size_t p = 0; p < spec.pins.size(); ++p) {
    PrescribedMotion& motion = spec.pins[p].motion;
    motion.film = film(motion.film_source, fmt::format("/pins/{}/motion/film", p));
  }
  spec.rest_film = film(body.rest_film, "/rest_film");
}

/// The rest shape is that of the film at the time 0, and where the body was is where it starts.
void take_rest_of_film(BodySpec& spec) {
  if (!spec.rest_film || spec.rest_film->n_vertices() != spec.mesh.n_vertices()) return;
  spec.start = spec.mesh.vertices;
  spec.rest_film->at(0, spec.mesh.vertices);
}

}  // namespace

BodySpec placed_body(const RunConfig& config, std::size_t i) {
  const BodyConfig& body = config.scene.bodies[i];
  BodySpec spec = body.spec;
  const std::string where = fmt::format("{}#/scene/bodies/{}", config.source, i);
  MeshFile made = make_mesh(body.mesh, where + "/mesh");
  spec.mesh = std::move(made.mesh);
  take_pinned_objects(made.objects, body.mesh, where, spec.pins);
  take_films(body, where, spec);
  apply(body.transform, spec.mesh.vertices);
  take_rest_of_film(spec);
  if (body.rest_mesh.given()) {
    take_rest_shape(body, where + "/rest_mesh", spec);
  }
  spec.weights = make_weights(body.weights, spec.start ? *spec.start : spec.mesh.vertices, where);
  return spec;
}

namespace {

Scene build_bodies(const RunConfig& config, const std::optional<StrainLimitSpec>& limit) {
  SceneBuilder builder("bodies", config.scene.planar, config.scene.gravity, config.source + "#/scene");
  builder.set_planar_pairs(config.scene.pairs);
  builder.set_gravity(config.scene.gravity_keys);
  builder.set_air(config.scene.air);
  builder.set_damping(config.scene.damping);
  for (std::size_t i = 0; i < config.scene.bodies.size(); ++i) {
    const BodyConfig& body = config.scene.bodies[i];
    BodySpec spec = placed_body(config, i);
    if (body.limited) spec.material.limit = limit;
    spec.d_hat = body.d_hat.value_or(config.formulation.d_hat);
    builder.add_body(spec);
  }
  for (std::size_t i = 0; i < config.scene.stitches.size(); ++i) {
    builder.add_stitch(config.scene.stitches[i], fmt::format("/stitches/{}", i));
  }
  for (const Obstacle& obstacle : config.scene.obstacles) builder.add_obstacle(obstacle);
  if (!bounds_motions(config)) builder.set_unbounded_motions(config.step_solver.name);
  for (std::size_t i = 0; i < config.scene.collisions.size(); ++i) {
    builder.add_collision(config.scene.collisions[i], fmt::format("/collisions/{}", i));
  }
  return builder.finish();
}

/// Everything that has a place. The rest shape stays where it is: only lengths and angles of it are read, and they
/// should not depend on where the scene is.
void translate(const Vec3d& by, Scene& scene) {
  if (by.isZero(0)) return;
  scene.x0.colwise() += by;
  for (Obstacle& obstacle : scene.obstacles) {
    obstacle.point += by;
    obstacle.motion.translate(by);
  }
  for (PrescribedMotion& motion : scene.motions) motion.translate(by);
}

/// Uniform in [-1, 1) from the top 53 bits, the same on every platform.
double unit_noise(std::mt19937_64& random) { return 2 * (static_cast<double>(random() >> 11) * 0x1p-53) - 1; }

void jitter(const SeedsConfig& seeds, Scene& scene) {
  if (seeds.jitter == 0) return;
  std::vector<char> is_free(static_cast<std::size_t>(scene.n_vertices()), 1);
  for (const Pin& pin : scene.pins) {
    if (!(pin.span.hold > 0)) is_free[static_cast<std::size_t>(pin.vertex)] = 0;
  }
  std::mt19937_64 random(seeds.main);
  for (int v = 0; v < scene.n_vertices(); ++v) {
    for (int k = 0; k < (scene.planar ? 2 : 3); ++k) {
      const double move =
          seeds.jitter * unit_noise(random);  // drawn for pinned vertices too: the others keep theirs
      if (is_free[static_cast<std::size_t>(v)]) scene.x0(k, v) += move;
    }
  }
}

/// Nothing starts, and nothing is driven, to where its coordinates lose their meaning. Prescribed vertices
/// are checked in their last pose; before it, a turn can put them at most two radii farther out.
void check_places(const RunConfig& config, const Scene& scene) {
  const auto refuse = [&](const char* found) {
    throw ConfigError(config.source + "#/scene", found,
                      fmt::format("coordinates between -{0:g} and {0:g} m", max_coordinate));
  };
  if (!within_bounds(scene.x0)) refuse("a vertex that starts too far out (seeds.jitter_m)");
  const double end = config.time.dt * config.time.steps;
  for (const Pin& pin : scene.pins) {
    if (!within_bounds(pin_pose(scene, pin, std::min(end, pin.span.release))))
      refuse("a prescribed vertex that is driven too far out");
  }
}

}  // namespace

Scene build_scene(const RunConfig& config) {
  std::optional<StrainLimitSpec> limit;
  if (config.strain_limit.enabled) {
    limit = {config.strain_limit.onset, config.strain_limit.width,
             config.strain_limit.solids.value_or(false)};
  }
  Scene scene;
  if (config.scene.name == "bodies") {
    scene = build_bodies(config, limit);
  } else {
    const ProceduralScene& source =
        procedural_scenes().require(config.scene.name, config.source + "#/scene/name");
    scene = source.build(config.scene.parameters, {config.formulation.d_hat, limit});
  }
  translate(config.scene.translation, scene);
  jitter(config.seeds, scene);
  check_places(config, scene);
  round_state(config.precision, scene.x0);
  return scene;
}

}  // namespace bb
