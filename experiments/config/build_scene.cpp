// From a config to the numbers of its scene.
#include <Eigen/Geometry>
#include <numbers>
#include <random>

#include "barriers/named_entries.hpp"
#include "core/mesh/read_mesh.hpp"
#include "core/scene/scene_builder.hpp"
#include "experiments/config/mesh_generators.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/scenes/procedural_scene.hpp"

namespace bb {
namespace {

TriangleMesh make_mesh(const MeshSource& source) {
  if (!source.file.empty()) return read_mesh(source.file);
  return require_entry(mesh_generators(), source.generator, "mesh/generator").make(source.parameters);
}

void apply(const TransformConfig& transform, Positions& x) {
  x *= transform.scale;
  if (transform.angle != 0) {
    const Eigen::AngleAxisd turn(transform.angle * std::numbers::pi / 180, transform.axis);
    x = turn.toRotationMatrix() * x;
  }
  x.colwise() += transform.translation;
}

Scene build_bodies(const RunConfig& config, const std::optional<StrainLimitSpec>& limit) {
  SceneBuilder builder("bodies", config.scene.planar, config.scene.gravity, config.source + "#/scene");
  builder.set_planar_pairs(config.scene.pairs);
  for (const BodyConfig& body : config.scene.bodies) {
    BodySpec spec = body.spec;
    spec.mesh = make_mesh(body.mesh);
    apply(body.transform, spec.mesh.vertices);
    if (body.limited) spec.material.limit = limit;
    if (spec.d_hat == 0) spec.d_hat = config.formulation.d_hat;
    builder.add_body(spec);
  }
  for (const Obstacle& obstacle : config.scene.obstacles) builder.add_obstacle(obstacle);
  return builder.finish();
}

/// Uniform in [-1, 1) from the top 53 bits, the same on every platform.
double unit_noise(std::mt19937_64& random) { return 2 * (static_cast<double>(random() >> 11) * 0x1p-53) - 1; }

void jitter(const SeedsConfig& seeds, Scene& scene) {
  if (seeds.jitter == 0) return;
  std::vector<char> is_free(static_cast<std::size_t>(scene.n_vertices()), 1);
  for (const Pin& pin : scene.pins) is_free[static_cast<std::size_t>(pin.vertex)] = 0;
  std::mt19937_64 random(seeds.main);
  for (int v = 0; v < scene.n_vertices(); ++v) {
    for (int k = 0; k < (scene.planar ? 2 : 3); ++k) {
      const double move =
          seeds.jitter * unit_noise(random);  // drawn for pinned vertices too: the others keep theirs
      if (is_free[static_cast<std::size_t>(v)]) scene.x0(k, v) += move;
    }
  }
}

}  // namespace

Scene build_scene(const RunConfig& config) {
  std::optional<StrainLimitSpec> limit;
  if (config.strain_limit.enabled) limit = config.strain_limit.limit;
  Scene scene;
  if (config.scene.name == "bodies") {
    scene = build_bodies(config, limit);
  } else {
    const ProceduralScene& source =
        require_entry(procedural_scenes(), config.scene.name, config.source + "#/scene/name");
    scene = source.build(config.scene.parameters, {config.formulation.d_hat, limit});
  }
  jitter(config.seeds, scene);
  return scene;
}

}  // namespace bb
