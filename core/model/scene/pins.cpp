// What of a scene is given as a function of time.
#include <algorithm>

#include "core/model/scene/scene.hpp"

namespace bb {

Vec3d pin_pose(const Scene& scene, const Pin& pin, double t) {
  return scene.motions[static_cast<std::size_t>(pin.motion)].pose(pin.vertex, scene.x0.col(pin.vertex), t);
}

Vec3d pin_velocity(const Scene& scene, const Pin& pin, double t, double dt) {
  const double h = dt / 16;
  const Vec3d x = pin_pose(scene, pin, t), before = pin_pose(scene, pin, t - h);
  return (3 * x - 4 * before + pin_pose(scene, pin, t - 2 * h)) / (2 * h);
}

std::vector<int> holding_pins(const Scene& scene, double middle) {
  std::vector<int> out;
  for (std::size_t i = 0; i < scene.pins.size(); ++i) {
    if (scene.pins[i].span.holds(middle)) out.push_back(static_cast<int>(i));
  }
  return out;
}

std::size_t free_dofs(const Scene& scene) {
  const std::size_t per_vertex = scene.planar ? 2 : 3;
  return per_vertex * (static_cast<std::size_t>(scene.n_vertices()) - holding_pins(scene, 0).size());
}

Scene held_scene(const Scene& scene, const std::vector<int>& holding) {
  Scene out = scene;
  out.pins.clear();
  for (const int i : holding) {
    const Pin& pin = scene.pins[static_cast<std::size_t>(i)];
    out.pins.push_back({pin.vertex, pin.motion});
    out.mass[static_cast<std::size_t>(pin.vertex)] = 0;
  }
  return out;
}

Vec3d gravity_at(const Scene& scene, double t) {
  return scene.gravity_keys.empty() ? scene.gravity : value_at(scene.gravity_keys, t);
}

double largest_gravity(const Vec3d& constant, const std::vector<GravityKey>& keys) {
  double out = keys.empty() ? constant.norm() : 0;
  for (const GravityKey& key : keys) out = std::max(out, key.value.norm());
  return out;
}

}  // namespace bb
