// What of a scene is given as a function of time.
#include "core/scene/scene.hpp"

namespace bb {

Vec3d pin_pose(const Scene& scene, const Pin& pin, double t) {
  return scene.motions[static_cast<std::size_t>(pin.motion)](scene.x0.col(pin.vertex), t);
}

Vec3d gravity_at(const Scene& scene, double t) {
  return scene.gravity_keys.empty() ? scene.gravity : value_at(scene.gravity_keys, t);
}

}  // namespace bb
