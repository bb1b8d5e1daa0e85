#include "experiments/microbenchmarks/cloth_stack.hpp"

#include <random>

#include "core/model/bodies/scene_builder.hpp"
#include "core/model/mesh/generators.hpp"

namespace bb::bench {

Positions moved(const Positions& x, double size, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> offset(-size, size);
  Positions out = x;
  for (Eigen::Index i = 0; i < out.size(); ++i) out.data()[i] += offset(random);
  return out;
}

Scene cloth_stack(int layers, int n) {
  constexpr double d_hat = 5e-3;
  SceneBuilder builder("cloth_stack", false, Vec3d(0, 0, -9.81), "cloth_stack");
  for (int layer = 0; layer < layers; ++layer) {
    BodySpec cloth;
    cloth.name = "layer" + std::to_string(layer);
    cloth.mesh = grid_mesh(n, n, 1.0, 1.0);
    cloth.mesh.vertices.colwise() += Vec3d(0.3 * layer / n, 0.2 * layer / n, 0.5 * d_hat * layer);
    cloth.material.bending = 1e-5;
    cloth.material.springs = 10;
    cloth.material.limit = StrainLimitSpec{0.02, 0.18};
    cloth.d_hat = d_hat;
    builder.add_body(cloth);
  }
  Scene scene = builder.finish();
  scene.x0 = moved(scene.rest, 0.1 * d_hat, 1);
  return scene;
}

}  // namespace bb::bench
